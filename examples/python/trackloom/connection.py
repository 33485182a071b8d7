"""Requests to a service, with its key, its refusals as exceptions, and a second try where it asks for one."""

from __future__ import annotations

import time
from typing import Any

import httpx

from .errors import Refused

# A service that is full says when to come again.
_AGAIN = {429, 503}
_TRIES = 5
_LONGEST_PAUSE_S = 30.0


class Connection:
    """One service."""

    def __init__(self, url: str, key: str | None, timeout_s: float) -> None:
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        # A job may be waited for, so answers take as long as they take.
        timeout = httpx.Timeout(timeout_s, read=None)
        self.http = httpx.Client(base_url=url, headers=headers, timeout=timeout)

    def send(self, method: str, path: str, **options: Any) -> httpx.Response:
        """An answer that is no refusal.

        Raises:
            Refused: of every status from 400 on.
        """
        for attempt in range(1, _TRIES + 1):
            answer = self.http.request(method, path, **options)
            if answer.status_code not in _AGAIN or attempt == _TRIES:
                break
            time.sleep(_pause_s(answer, attempt))
        if answer.is_error:
            raise Refused(answer.status_code, _problem(answer))
        return answer

    def get(self, path: str, **query: Any) -> Any:
        """The JSON at a path."""
        told = {name: value for name, value in query.items() if value is not None}
        return self.send("GET", path, params=told).json()


def _pause_s(answer: httpx.Response, attempt: int) -> float:
    try:
        wanted = float(answer.headers.get("Retry-After", ""))
    except ValueError:
        wanted = 0.5 * 2.0**attempt
    return min(wanted, _LONGEST_PAUSE_S)


def _problem(answer: httpx.Response) -> dict[str, Any]:
    try:
        found = answer.json()
    except ValueError:
        found = None
    return found if isinstance(found, dict) else {"detail": answer.text[:500]}
