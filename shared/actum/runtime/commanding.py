"""Answers the commands that a service is asked by Zenoh queries."""

from collections.abc import Callable, Sequence
from typing import Any

import zenoh

from actum import keys
from actum.commands import JSON, MSGPACK, Command, Refusal, described, packed, unpacked
from actum.node import Counters
from actum.runtime.turns import Turns
from actum.settings import ServiceSettings


class Commander:
    """One queryable for all commands of a service.

    Args:
        commands: what it offers.
        settings: whose sensor stands in the keys.
        service: its name.
        counters: count what is refused.
        lock: held while a command is carried out.
        end_at_bug: called with what was done and the exception where a handler raises anything but a refusal.
    """

    def __init__(
        self,
        commands: Sequence[Command[Any, Any]],
        settings: ServiceSettings,
        service: str,
        counters: Counters,
        lock: Turns,
        end_at_bug: Callable[[str, BaseException], None],
    ) -> None:
        self._commands = {each.name: each for each in commands}
        self._base = keys.commands_key(settings.sensor, service)
        self._counters, self._lock, self._end_at_bug = counters, lock, end_at_bug

    def declare(self, session: zenoh.Session) -> "zenoh.Queryable[None]":
        """Answer queries from now on, until the queryable is undeclared."""
        return session.declare_queryable(f"{self._base}/**", self._answer, complete=True)

    def _answer(self, query: zenoh.Query) -> None:
        """Answer one query: with the reply, the reason for a refusal, or the list of commands."""
        payload = b"" if query.payload is None else query.payload.to_bytes()
        encoding = MSGPACK if str(query.encoding).startswith(MSGPACK) else JSON
        with query:
            try:
                name = self._asked(query.key_expr)
                reply = self._obey(name, unpacked(payload, encoding))
                query.reply("/".join([self._base, *name]), _packed_reply(reply, encoding), encoding=encoding)
            except Refusal as refusal:
                with self._lock:
                    self._counters.reject("refused_command", str(refusal))
                query.reply_err(packed({"error": str(refusal)}, encoding), encoding=encoding)
            except Exception as error:
                problem = (
                    "a bug occurred in the service while it carried out the command, so the command may be done only "
                    "in part, and the service stops: report the bug with the last lines of the service's log"
                )
                try:
                    query.reply_err(packed({"error": problem}, encoding), encoding=encoding)
                finally:  # the session may be closing already
                    self._end_at_bug(f"while the service carried out the command {query.key_expr}", error)

    def _asked(self, asked: zenoh.KeyExpr) -> list[str]:
        """Return the command's name as the last chunks of its key; none where the list of commands is asked for.

        Raises:
            Refusal: there is no such command, or several are meant, which nobody wants done at once.
        """
        meant = [[name] for name in self._commands if asked.intersects(zenoh.KeyExpr(f"{self._base}/{name}"))]
        if asked.intersects(zenoh.KeyExpr(self._base)):
            meant.append([])
        if len(meant) != 1:
            raise Refusal(
                f"the key {asked} matches {len(meant)} commands instead of one: use one of the commands "
                f"{', '.join(sorted(self._commands))}"
            )
        return meant[0]

    def _obey(self, name: list[str], fields: dict[str, Any]) -> dict[str, Any]:
        if not name:
            return described(list(self._commands.values())).model_dump()
        with self._lock:
            return self._commands[name[0]].obey(fields)


def _packed_reply(reply: dict[str, Any], encoding: str) -> bytes:
    """Encode what a command answers.

    Raises:
        Refusal: it holds what the encoding has no form for, such as NaN that stood in a file.
    """
    try:
        return packed(reply, encoding)
    except Refusal as problem:
        raise Refusal(f"the command was carried out, but its reply cannot be sent: {problem}") from None
