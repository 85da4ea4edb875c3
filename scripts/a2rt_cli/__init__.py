"""What the user types: `scripts/a2rt COMMAND`. One module per command in a2rt_cli/commands.

Start reading at app.py, then setup/ (how a machine is made ready), engine/ (how the C++ programs
are run) and report/ (how results become a page).
"""
