"""Packs the extension modules of all processor levels and the programs into one wheel: see tools/wheel.

The first module is the lowest level's, and becomes ``spherule/_spherule.abi3.so``; the others go to
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

PACKAGE = Path(__file__).parent / "spherule"
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
    parser.add_argument("modules", nargs="+", metavar="LEVEL=MODULE")
    parser.add_argument("--metadata", type=Path, required=True, help="the folder .dist-info that maturin writes")
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--libexec", type=Path)
    parser.add_argument("--license", type=Path, action="append", default=[])
    parser.add_argument("--compression", type=int, default=9)
    options = parser.parse_args()

    (_, first), *others = (item.split("=", 1) for item in options.modules)
    files: dict[str, tuple[bytes, bool]] = {MODULE: (Path(first).read_bytes(), True)}
    for path in PACKAGE.iterdir():
        if path.suffix in (".py", ".pyi", ".typed"):
            files[f"{PACKAGE.name}/{path.name}"] = (path.read_bytes(), False)
    folder = options.metadata.name
    data = folder.replace(".dist-info", ".data")
    for path in options.metadata.iterdir():
        files[f"{folder}/{path.name}"] = (path.read_bytes(), False)
    for level, module in others:
        files[MODULE.replace("/", f"/_levels/{level}/")] = (Path(module).read_bytes(), True)
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

    facts = files[f"{folder}/WHEEL"][0].decode()
    built_for = re.search(r"^Tag: \w+-\w+-(\S+)$", facts, re.MULTILINE)
    if built_for is None:
        parser.error(f"{options.metadata / 'WHEEL'} has no tag")
    tag = built_for[0].replace(
        built_for[1], platform_tag(built_for[1], (content for content, executable in files.values() if executable))
    )
    files[f"{folder}/WHEEL"] = (facts.replace(built_for[0], tag).encode(), False)

    record = []
    for name, (content, _) in sorted(files.items()):
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record.append(f"{name},sha256={digest},{len(content)}\n")
    record.append(f"{folder}/RECORD,,\n")
    files[f"{folder}/RECORD"] = ("".join(record).encode(), False)

    moment = time.gmtime(max(int(os.environ.get("SOURCE_DATE_EPOCH", "0")), 315_532_800))
    # The files that tell what it is come last, as the format asks for.
    order = sorted(files, key=lambda name: (".dist-info/" in name, name))
    packed = options.out / f"{folder.removesuffix('.dist-info')}-{tag.removeprefix('Tag: ')}.whl"
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=options.compression) as wheel:
        for name in order:
            content, executable = files[name]
            info = zipfile.ZipInfo(name, moment[:6])
            info.external_attr = (0o100755 if executable else 0o100644) << 16
            info.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(info, content)


if __name__ == "__main__":
    main()
