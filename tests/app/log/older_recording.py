"""Recordings as they were before some of their columns came."""

import re
from pathlib import Path

from mcap.reader import make_reader
from mcap.writer import Writer


def older(path: Path, copy: Path, absent: set[str]) -> None:
    """The recording as it was before these columns came."""
    with path.open("rb") as source, copy.open("wb") as target:
        reader, writer = make_reader(source), Writer(target)
        writer.start()
        channels: dict[int, int] = {}
        summary = reader.get_summary()
        assert summary is not None
        kept: dict[int, list[slice]] = {}
        for number, channel in summary.channels.items():
            schema = summary.schemas[channel.schema_id]
            text, at, parts = "", 12, []  # behind CDR's head and the tick
            for line in schema.data.decode().splitlines(keepends=True):
                found = re.match(r"float64(?:\[(\d+)\])? (\w+)", line)
                size = 8 * int(found[1] or 1) if found else 0
                if found is None or found[2] not in absent:
                    text += line
                    parts.append(slice(at, at + size))
                at += size
            if schema.encoding == "ros2msg":
                kept[number] = [slice(0, 12), *parts, slice(at, None)]
            known = writer.register_schema(schema.name, schema.encoding, text.encode())
            channels[number] = writer.register_channel(channel.topic, channel.message_encoding, known)
        for each in reader.iter_attachments():
            writer.add_attachment(each.create_time, each.log_time, each.name, each.media_type, each.data)
        for each in reader.iter_metadata():
            writer.add_metadata(each.name, each.metadata)
        for _, channel, message in reader.iter_messages():
            data = message.data
            parts = kept.get(channel.id, [slice(None)])
            data = b"".join(data[part] for part in parts)
            writer.add_message(channels[channel.id], message.log_time, data, message.publish_time, message.sequence)
        writer.finish()
