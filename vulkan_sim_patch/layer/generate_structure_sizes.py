"""Turn vulkan_core.h into rows {structure type, size} (feature_chain.cpp includes them)."""

import argparse
import re
from pathlib import Path

STRUCTURE = re.compile(r"typedef struct (Vk\w+) \{\s*VkStructureType\s+sType;\s*(?:const )?void\*")
ENUMERATOR = re.compile(r"^\s+(VK_STRUCTURE_TYPE_\w+) = \d+,", re.MULTILINE)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("header", type=Path, help="vulkan_core.h")
    parser.add_argument("output", type=Path, help="file of table rows to write")
    arguments = parser.parse_args()
    text = arguments.header.read_text()
    # The two spellings differ in underscores and case only.
    types = {
        name.removeprefix("VK_STRUCTURE_TYPE_").replace("_", "").lower(): name
        for name in ENUMERATOR.findall(text)
    }
    rows = []
    for structure in STRUCTURE.findall(text):
        name = types.get(structure.removeprefix("Vk").lower())
        if name is not None:
            rows.append(f"{{{name}, sizeof({structure})}},")
    temporary = arguments.output.with_suffix(".tmp")
    temporary.write_text("\n".join(rows) + "\n")
    temporary.replace(arguments.output)


if __name__ == "__main__":
    main()
