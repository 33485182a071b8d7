"""Datasets of a service."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from .connection import Connection

if TYPE_CHECKING:
    import pandas as pd


class Dataset:
    """A recording, truth or tracks in the service."""

    def __init__(self, connection: Connection, info: dict[str, Any]) -> None:
        self._connection = connection
        self.info = info

    @property
    def id(self) -> str:
        """The id that requests name."""
        return str(self.info["id"])

    @property
    def source(self) -> dict[str, str]:
        """As a request names it: `{"input": recording.source}`."""
        return {"source": "dataset", "dataset_id": self.id}

    def table(self) -> pd.DataFrame:
        """Its rows as CSV has them, every name as text. Needs pandas."""
        answer = self._connection.send("GET", f"/v1/datasets/{self.id}/content", params={"format": "csv"})
        return read_table(answer.content)

    def delete(self) -> None:
        """Deletes it, unless a job needs it."""
        self._connection.send("DELETE", f"/v1/datasets/{self.id}")

    def __repr__(self) -> str:
        return f"<Dataset {self.info.get('name', self.id)}: {self.info['kind']}, {self.info.get('rows')} rows>"


def read_table(content: bytes) -> pd.DataFrame:
    """CSV as a data frame; columns that name something stay text, so that track 007 is not 7."""
    import pandas as pd

    head = content.split(b"\n", 1)[0].decode().strip().split(",")
    names = {column: "string" for column in head if column.endswith("_id") or column == "name"}
    return pd.read_csv(io.BytesIO(content), dtype=names)
