"""Debian packages: what is installed, what is missing, how to get it.

No registry's host is ever written here: a backports source is derived from the sources the system
already uses, in either of apt's two styles.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from a2rt_cli.errors import UserError
from a2rt_cli.paths import LOGS, SCRIPTS
from a2rt_cli.process import ProgramFailed, run_logged
from a2rt_cli.setup.needs import Need

PACKAGE_FILE = SCRIPTS / "packages.txt"
_LEAST_NEEDS = {"tests:": Need.TESTS, "slow:": Need.SLOW_TESTS}
APT_FOLDER = Path("/etc/apt")
BACKPORTS_FILE = "a2rt-backports.sources"


@dataclass(frozen=True)
class Package:
    name: str
    least: str = ""  # least upstream version, e.g. "25.0"
    backports: bool = False
    least_need: Need = Need.PYTHON  # first level of commands that wants it


@dataclass(frozen=True)
class Source:
    """One archive that apt reads."""

    uri: str
    suites: tuple[str, ...]
    components: tuple[str, ...]
    signed_by: str


def read_packages(text: str) -> list[Package]:
    packages = []
    for line in text.splitlines():
        words = line.split("#")[0].split()
        if not words:
            continue
        if words[0] == "backports:":
            packages.append(Package(words[1], words[2], backports=True))
        elif words[0] in _LEAST_NEEDS:
            packages.append(Package(words[1], least_need=_LEAST_NEEDS[words[0]]))
        else:
            packages.append(Package(words[0]))
    return packages


def wanted_packages(need: Need = Need.ENGINE) -> list[Package]:
    """What commands of this need want."""
    everything = read_packages(PACKAGE_FILE.read_text(encoding="utf-8"))
    return [package for package in everything if need.includes(package.least_need)]


def codename() -> str:
    """Release name from os-release, e.g. "bookworm"."""
    text = Path("/etc/os-release").read_text(encoding="utf-8")
    match = re.search(r"^VERSION_CODENAME=\"?([a-z]+)", text, re.MULTILINE)
    if match is None or not shutil.which("apt-get"):
        raise UserError(
            "this system is not a Debian 12 or 13",
            "install the packages named in scripts/packages.txt in your system's own way; "
            "set-up skips this step when `dpkg` shows them",
        )
    return match[1]


def parse_deb822(text: str) -> list[Source]:
    """Sources from a .sources file (deb822 style)."""
    found = []
    for stanza in re.split(r"\n\s*\n", text):
        fields: dict[str, str] = {}
        key = ""
        for line in stanza.splitlines():
            if line.startswith("#"):
                continue
            if line[:1].isspace() and key:
                fields[key] += "\n" + line.strip()
            elif ":" in line:
                key, value = line.split(":", 1)
                key = key.strip().lower()
                fields[key] = value.strip()
        disabled = fields.get("enabled", "yes").lower() in ("no", "false", "0")
        if disabled or "deb" not in fields.get("types", "").split():
            continue
        for uri in fields.get("uris", "").split():
            suites, parts = fields.get("suites", "").split(), fields.get("components", "").split()
            found.append(Source(uri, tuple(suites), tuple(parts), fields.get("signed-by", "")))
    return found


def parse_one_line(text: str) -> list[Source]:
    """Sources from a sources.list file (one-line style)."""
    found = []
    for line in text.splitlines():
        match = re.match(r"^\s*deb\s+(?:\[([^\]]*)\]\s+)?(\S+)\s+(\S+)\s*(.*)$", line.split("#")[0])
        if match is None:
            continue
        options, uri, suite, components = match.groups()
        signed = re.search(r"signed-by=(\S+)", options or "")
        parts = tuple(components.split())
        found.append(Source(uri, (suite,), parts, signed[1] if signed else ""))
    return found


def read_sources(folder: Path = APT_FOLDER) -> list[Source]:
    lists = [folder / "sources.list", *sorted((folder / "sources.list.d").glob("*.list"))]
    sources = []
    for path in sorted((folder / "sources.list.d").glob("*.sources")):
        sources += parse_deb822(path.read_text(encoding="utf-8"))
    for path in lists:
        if path.is_file():
            sources += parse_one_line(path.read_text(encoding="utf-8"))
    return sources


def backports_stanza(sources: Sequence[Source], release: str) -> str | None:
    """The text of a backports source on the archive the system uses; None if it has one."""
    suite = f"{release}-backports"
    if any(suite in source.suites for source in sources):
        return None
    main = [s for s in sources if release in s.suites and "main" in s.components]
    if not main:
        raise UserError(
            f"no apt source offers {release} main, so {suite} cannot be derived from it",
            f"add {suite} to your apt sources, then run the command again",
        )
    signed = f"Signed-By: {main[0].signed_by}\n" if main[0].signed_by else ""
    return f"Types: deb\nURIs: {main[0].uri}\nSuites: {suite}\nComponents: main\n{signed}"


def installed_versions(names: Sequence[str]) -> dict[str, str]:
    """Versions of those of `names` that are installed."""
    if not shutil.which("dpkg-query"):
        return {}
    form = "${Package}\t${Version}\t${db:Status-Status}\n"
    reply = subprocess.run(
        ["dpkg-query", "-W", f"--showformat={form}", *names],
        capture_output=True,
        text=True,
        check=False,
    )
    rows = (line.split("\t") for line in reply.stdout.splitlines())
    return {name: version for name, version, state in rows if state == "installed"}


def upstream_at_least(version: str, least: str) -> bool:
    """Whether a Debian version's upstream part is `least` or later."""

    def numbers(text: str) -> list[int]:
        return [int(n) for n in re.findall(r"\d+", re.split(r"[-+~]", text.split(":")[-1])[0])]

    return numbers(version) >= numbers(least)


def missing_packages(need: Need = Need.ENGINE) -> list[Package]:
    wanted = wanted_packages(need)
    have = installed_versions([package.name for package in wanted])
    return [
        package
        for package in wanted
        if package.name not in have
        or (package.least and not upstream_at_least(have[package.name], package.least))
    ]


def install_commands(packages: Sequence[Package], backports_suite: str | None) -> list[list[str]]:
    """apt commands that install `packages`; without privilege prefix."""
    install = ["apt-get", "install", "-y", "--no-install-recommends"]
    plain = [p.name for p in packages if not (p.backports and backports_suite)]
    ported = [p.name for p in packages if p.backports and backports_suite]
    commands = []
    if plain:
        commands.append([*install, *plain])
    if ported:
        commands.append([*install, "-t", str(backports_suite), *ported])
    return commands


def privileged(command: Sequence[str]) -> list[str]:
    """`command` run as root: as it is, or through sudo."""
    with_env = ["env", "DEBIAN_FRONTEND=noninteractive", *command]
    if os.geteuid() == 0:
        return with_env
    if shutil.which("sudo"):
        return ["sudo", "-n", *with_env]
    raise UserError(
        "packages are missing, and this user is neither root nor allowed to use sudo",
        f"as root, run: {' '.join(command)}",
    )


def _needs_backports(packages: Sequence[Package]) -> str | None:
    """The suite to take new versions from; Debian 13 has them in main."""
    release = codename()
    if release == "bookworm" and any(package.backports for package in packages):
        return f"{release}-backports"
    return None


def install(packages: Sequence[Package], say) -> None:
    """Installs `packages`. `say(fraction, words)` is told what happens."""
    log = LOGS / "setup-packages.log"
    suite = _needs_backports(packages)
    remedy = (
        "check the network and apt's sources, then run the command again; or as root: "
        + " && ".join(" ".join(command) for command in install_commands(packages, suite))
    )
    if os.geteuid() != 0 and shutil.which("sudo"):
        # Asks for the password once, on the terminal, where there is one.
        subprocess.run(["sudo", "-v"], check=False)
    if suite:
        stanza = backports_stanza(read_sources(), codename())
        if stanza is not None:
            say(0.0, f"adding {suite}")
            target = APT_FOLDER / "sources.list.d" / BACKPORTS_FILE
            script = f"cat > {target} <<'END'\n{stanza}END\nchmod 644 {target}"
            command = privileged(["sh", "-c", script])
            run_logged(command, log, what="adding the backports source", remedy=remedy)
    steps = [["apt-get", "update"], *install_commands(packages, suite)]
    unpacked = 0

    def count(line: str) -> None:
        nonlocal unpacked
        if line.startswith(("Unpacking ", "Setting up ")):
            unpacked += 1
            say(None, line[:60])

    for index, command in enumerate(steps):
        say(index / len(steps), " ".join(command[:2]))
        full = [*command[:1], "-o", "DPkg::Lock::Timeout=300", *command[1:]]
        try:
            run_logged(
                privileged(full), log, what="installing packages", remedy=remedy, on_line=count
            )
        except ProgramFailed:
            # A stale or unreachable list must not stop an install that the cache can serve.
            if command[-1] != "update":
                raise
