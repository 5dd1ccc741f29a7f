"""Recordings whose container is sound, and whose contents are not: a topic missing, shorter, renamed, of another type."""

import io
from collections.abc import Sequence
from typing import Any

import msgspec
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

TOPICS = ("/state", "/truth", "/pendant", "/tf", "/events", "/settings")
EDITS = ("drop", "rename", "shorten", "type", "value", "attachment", "note", "twist")
ODD: tuple[Any, ...] = (None, -1, 1e300, "x", [], {}, True, 2**60)


def rewritten(data: bytes) -> st.SearchStrategy[bytes]:
    """The recording with one to three things changed."""
    change = st.tuples(st.sampled_from(EDITS), st.integers(0, 2**31), st.sampled_from(ODD))
    return st.lists(change, min_size=1, max_size=3).map(lambda changes: rewrite(data, changes))


def rewrite(data: bytes, changes: Sequence[tuple[str, int, Any]]) -> bytes:
    """The recording with changes: one of EDITS, a number that says of which topic and where, and what is put there."""
    reader = make_reader(io.BytesIO(data))
    topics = ["/state", "/truth", "/pendant", "/tf", "/events", "/settings"]
    per_topic = {
        kind: {topics[number % 6]: (number // 6, odd) for what, number, odd in changes if what == kind} for kind in EDITS
    }
    out = io.BytesIO()
    writer = Writer(out, compression=CompressionType.ZSTD, chunk_size=200_000)
    writer.start()
    channels: dict[int, int] = {}
    schemas: dict[int, int] = {}
    seen: dict[str, int] = {}
    for attachment in reader.iter_attachments():
        hit = per_topic["attachment"].get("/tf" if attachment.name == "arm.json" else "/pendant")
        content = attachment.data if hit is None else _odd(attachment.data, *hit)
        writer.add_attachment(0, 0, attachment.name, attachment.media_type, content)
    for note in reader.iter_metadata():
        if "/state" in per_topic["note"] and note.name == "run":
            continue
        writer.add_metadata(note.name, note.metadata)
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        topic = channel.topic
        if topic in per_topic["drop"] or schema is None:
            continue
        seen[topic] = seen.get(topic, 0) + 1
        if topic in per_topic["shorten"] and seen[topic] > per_topic["shorten"][topic][0] % 200:
            continue
        if channel.id not in channels:
            schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
            encoding = channel.message_encoding
            if topic in per_topic["type"]:
                encoding = "json" if encoding == "cdr" else "cdr"
            name = topic + "x" if topic in per_topic["rename"] else topic
            channels[channel.id] = writer.register_channel(name, encoding, schemas[schema.id])
        content = message.data
        for kind in ("value", "twist"):
            if topic in per_topic[kind] and (kind == "twist" or seen[topic] == 1 + per_topic[kind][topic][0] % 60):
                content = _odd(content, *per_topic[kind][topic])
        writer.add_message(channels[channel.id], message.log_time, content, message.publish_time, message.sequence)
    writer.finish()
    return out.getvalue()


def _odd(content: bytes, number: int, odd: Any) -> bytes:
    """JSON with one value replaced; other bytes with some of them turned."""
    try:
        raw = msgspec.json.decode(content)
    except msgspec.DecodeError:
        at = number % len(content)
        return content[:at] + bytes(each ^ 0xFF for each in content[at : at + 8]) + content[at + 8 :]
    target, way = raw, number
    while isinstance(target, dict | list) and target:
        keys = list(target) if isinstance(target, dict) else list(range(len(target)))
        key = keys[way % len(keys)]
        way //= max(len(keys), 2)
        if not isinstance(target[key], dict | list) or not target[key] or way % 3 == 0:
            target[key] = odd
            break
        target = target[key]
    return msgspec.json.encode(raw)
