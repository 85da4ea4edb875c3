"""The subcommands, one module each; a new file here is a new command.

A module defines
  its docstring          first line: what the command does (shown in `a2rt --help`)
  EXAMPLES               lines for the end of `a2rt COMMAND --help`
  NEED                   a setup.needs.Need, or a function from the parsed arguments to one
  add_arguments(parser)  its options
  run(args) -> int       the exit status
and imports nothing but the standard library and a2rt_cli at its top, so that `--help` works on a
machine that is not set up yet.
"""
