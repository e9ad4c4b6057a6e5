"""The manifest of a ledger: what is run, with which versions, where; a folder belongs to the one it was begun with."""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from antgym.errors import LedgerError
from antgym.tuning.lines import sync_folder

MANIFEST = "manifest.json"
SCHEMA, OLDER = 2, (1,)
OURS = ("schema", "config", "pinned", "parts")


def read_manifest(folder: Path) -> dict[str, Any]:
    """Return the manifest of a ledger.

    Raises:
        LedgerError: if there is none, or none that can be read.
    """
    path = folder / MANIFEST
    try:
        fields: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        schema = fields["schema"]
    except OSError as error:
        raise LedgerError(f"{folder} is no ledger: {MANIFEST}: {error.strerror}") from None
    except (ValueError, KeyError, TypeError) as error:
        raise LedgerError(f"{path} is damaged ({error}); use another folder") from None
    if schema not in (SCHEMA, *OLDER):
        readable = ", ".join(map(str, (*OLDER, SCHEMA)))
        raise LedgerError(f"{path}: schema {schema}, this antgym reads {readable}; use another folder")
    if not isinstance(fields.get("config"), dict):
        raise LedgerError(f"{path} is damaged (it lacks the config); use another folder")
    return fields


class Manifest:
    """The manifest of an open ledger, written where there is none yet.

    Args:
        folder: of the ledger, which is locked.
        config: what is run, JSON; a folder made with another config is refused unless ``anew``.
        versions: library versions, kept from the first trial on; changes are named when a replay differs.
        facts: anything else worth keeping (commit, CPU, threads), JSON.
        anew: whether the folder holds no trial, so that what was begun there and never ran binds nobody.

    Attributes:
        fields: as they lie in the folder.
        renewed: whether the folder was begun with another config before.

    Raises:
        LedgerError: if the folder holds trials of another config, or its manifest is of another schema or damaged.
    """

    def __init__(
        self,
        folder: Path,
        config: Mapping[str, Any],
        versions: Mapping[str, str],
        facts: Mapping[str, Any],
        *,
        anew: bool,
    ) -> None:
        self._folder, self._versions = folder, dict(versions)
        begun = read_manifest(folder) if (folder / MANIFEST).exists() else None  # what is damaged is refused
        self.renewed = anew and begun is not None and begun["config"] != as_json(config)
        if anew or begun is None:
            self.fields = {"schema": SCHEMA, "config": as_json(config), "versions": self._versions, **facts}
            self._write()
        self.fields = read_manifest(folder)
        self._require(
            self.fields["config"], as_json(config), folder, "use another folder, or what it was begun with"
        )

    @property
    def schema(self) -> int:
        """In which the ledger was begun, and in which it goes on."""
        return int(self.fields["schema"])

    def changes(self) -> str:
        """Return the clause of a message that names versions that differ from the manifest's."""
        then = self.fields["versions"]
        names = sorted(set(then) | set(self._versions))
        changes = [
            f"{n} {then.get(n)} -> {self._versions.get(n)}"
            for n in names
            if then.get(n) != self._versions.get(n)
        ]
        return f" (versions changed: {', '.join(changes)})" if changes else " (no library version changed)"

    def pin(self, digests: Mapping[str, str]) -> None:
        """Tie the ledger to files by their hashes; LedgerError where one differs from what was pinned before."""
        pinned = self.fields.setdefault("pinned", {})
        for name, digest in digests.items():
            if pinned.setdefault(name, digest) != digest:
                raise LedgerError(
                    f"{name} is not the file that the runs in {self._folder} were made with; restore it or use "
                    "another folder"
                )
        self._write()

    def require_part(self, other: Mapping[str, Any], folder: Path) -> None:
        """Raise LedgerError unless another ledger's manifest is one of the same config."""
        self._require(other["config"], self.fields["config"], folder, f"it cannot be part of {self._folder}")

    def take_in(self, other: Mapping[str, Any]) -> None:
        """Note where a part of the runs was made: what its manifest tells of versions and machine.

        Raises:
            LedgerError: if it was tied to other files.
        """
        self.pin(other.get("pinned", {}))
        parts = self.fields.setdefault("parts", [])
        for part in other.get("parts") or [{name: other[name] for name in other if name not in OURS}]:
            if part not in parts:
                parts.append(part)
        self._write()

    @staticmethod
    def _require(found: Mapping[str, Any], asked: Mapping[str, Any], folder: Path, advice: str) -> None:
        if found != asked:
            keys = sorted(key for key in {*found, *asked} if found.get(key) != asked.get(key))
            then = "; ".join(f"{key}: {found.get(key)}, now {asked.get(key)}" for key in keys)
            raise LedgerError(f"{folder} was begun with other settings ({then}); {advice}")

    def _write(self) -> None:
        scratch = (self._folder / MANIFEST).with_suffix(".tmp")
        try:
            with scratch.open("w", encoding="utf-8") as file:
                file.write(json.dumps(self.fields, indent=2) + "\n")
                file.flush()
                os.fsync(file.fileno())
            os.replace(scratch, self._folder / MANIFEST)
            sync_folder(self._folder)
        except OSError as error:
            scratch.unlink(missing_ok=True)
            raise LedgerError(f"{self._folder} cannot hold a ledger: {error}") from None


def as_json(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return a config as JSON gives it back."""
    plain: dict[str, Any] = json.loads(json.dumps(dict(config)))
    return plain
