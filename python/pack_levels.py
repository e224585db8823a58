"""Packs the wheels of several processor levels into one, with the programs: see tools/wheel.

The first wheel is the lowest level's: its extension module stays what it is, and those of the others go to
``spherule/_levels/LEVEL``. The program goes where pip puts scripts, and its levels beside it, where it looks for them.
The tag of the platform is that of the newest symbol that any of them needs of the C library. Equal inputs give equal
bytes.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import os
import re
import time
import zipfile
from collections.abc import Iterable
from pathlib import Path

MODULE = "spherule/_spherule.abi3.so"


def platform_tag(tag: str, binaries: Iterable[bytes]) -> str:
    """The tag of PEP 600 for binaries of ``linux_ARCHITECTURE``; other tags stay as they are."""
    if not tag.startswith("linux_"):
        return tag
    versions = (int(minor) for binary in binaries for minor in re.findall(rb"GLIBC_2\.(\d+)", binary))
    # The first C library that the policy knows.
    return tag.replace("linux_", f"manylinux_2_{max(versions, default=17)}_")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("wheels", nargs="+", metavar="LEVEL=WHEEL")
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--libexec", type=Path)
    parser.add_argument("--license", type=Path, action="append", default=[])
    options = parser.parse_args()

    (_, first), *others = (item.split("=", 1) for item in options.wheels)
    files: dict[str, tuple[bytes, bool]] = {}
    with zipfile.ZipFile(first) as wheel:
        for info in wheel.infolist():
            # maturin's list of crates has a time and paths of this machine; THIRD-PARTY-LICENSES.txt lists them, too.
            if not info.filename.endswith("/RECORD") and ".dist-info/sboms/" not in info.filename:
                files[info.filename] = (wheel.read(info), info.filename.endswith(".so"))
    folder = next(name.split("/")[0] for name in files if ".dist-info/" in name)
    data = folder.replace(".dist-info", ".data")
    for level, path in others:
        with zipfile.ZipFile(path) as wheel:
            files[MODULE.replace("/", f"/_levels/{level}/")] = (wheel.read(MODULE), True)
    if others:
        for package in ("spherule/_levels", *(f"spherule/_levels/{level}" for level, _ in others)):
            files[f"{package}/__init__.py"] = (b"", False)
    files[f"{data}/scripts/spherule"] = (options.program.read_bytes(), True)
    if options.libexec:
        for path in sorted(options.libexec.rglob("*")):
            if path.is_file():
                name = f"{data}/data/libexec/{path.relative_to(options.libexec).as_posix()}"
                files[name] = (path.read_bytes(), True)

    for path in options.license:
        files[f"{folder}/licenses/{path.name}"] = (path.read_bytes(), False)

    *distribution, built_for = Path(first).stem.split("-")
    tag = platform_tag(built_for, (content for content, executable in files.values() if executable))
    facts, _ = files[f"{folder}/WHEEL"]
    files[f"{folder}/WHEEL"] = (facts.replace(f"-{built_for}\n".encode(), f"-{tag}\n".encode()), False)

    record = []
    for name, (content, _) in sorted(files.items()):
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record.append(f"{name},sha256={digest},{len(content)}\n")
    record.append(f"{folder}/RECORD,,\n")
    files[f"{folder}/RECORD"] = ("".join(record).encode(), False)

    moment = time.gmtime(max(int(os.environ.get("SOURCE_DATE_EPOCH", "0")), 315_532_800))
    # The files that tell what it is come last, as the format asks for.
    order = sorted(files, key=lambda name: (".dist-info/" in name, name))
    packed = options.out / f"{'-'.join([*distribution, tag])}.whl"
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as wheel:
        for name in order:
            content, executable = files[name]
            info = zipfile.ZipInfo(name, moment[:6])
            info.external_attr = (0o100755 if executable else 0o100644) << 16
            info.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(info, content)


if __name__ == "__main__":
    main()
