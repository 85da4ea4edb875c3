"""Turn spirv.core.grammar.json into the rows of the opcode table (opcodes.cpp includes them)."""

import argparse
import json
from pathlib import Path

CLASSES = {
    "Annotation": "kAnnotation",
    "Debug": "kDebug",
    "Mode-Setting": "kModeSetting",
    "Extension": "kExtension",
    "Type-Declaration": "kType",
    "Constant-Creation": "kConstant",
}


def row(instruction: dict) -> tuple[int, str]:
    operands = instruction.get("operands", [])
    kinds = {operand["kind"] for operand in operands}
    required = sum(1 for operand in operands if "quantifier" not in operand)
    opcode = instruction["opcode"]
    group = CLASSES.get(instruction.get("class", ""), "kOther")
    has_type = "true" if "IdResultType" in kinds else "false"
    has_result = "true" if "IdResult" in kinds else "false"
    text = (
        f'{{{opcode}, "{instruction["opname"]}", {has_type}, {has_result}, '
        f"{1 + required}, OpcodeClass::{group}}},"
    )
    return opcode, text


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("grammar", type=Path, help="spirv.core.grammar.json")
    parser.add_argument("output", type=Path, help="file of table rows to write")
    arguments = parser.parse_args()
    grammar = json.loads(arguments.grammar.read_text())
    rows: dict[int, str] = {}
    for instruction in grammar["instructions"]:
        opcode, text = row(instruction)
        # Older grammars repeat an opcode under its alias; the first spelling stands.
        rows.setdefault(opcode, text)
    temporary = arguments.output.with_suffix(".tmp")
    temporary.write_text("\n".join(rows[opcode] for opcode in sorted(rows)) + "\n")
    temporary.replace(arguments.output)


if __name__ == "__main__":
    main()
