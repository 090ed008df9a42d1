"""A proxy that takes TLS connections and passes their bytes on as they are: tls_proxy.py CERTIFICATE KEY NOTED.

It prints its port, reads the port behind it from its input, and writes what clients sent to the file NOTED.
"""

from __future__ import annotations

import asyncio
import functools
import ssl
import sys
from typing import BinaryIO


async def pass_on(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, noted: BinaryIO | None) -> None:
    try:
        while received := await reader.read(1 << 16):
            if noted:
                noted.write(received)
            writer.write(received)
            await writer.drain()
    except OSError:
        pass
    finally:
        writer.close()


async def serve(
    target: asyncio.Future[int], noted: BinaryIO, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
) -> None:
    there, back = await asyncio.open_connection("127.0.0.1", await target)
    await asyncio.gather(pass_on(reader, back, noted), pass_on(there, writer, None))


async def main(certificate: str, key: str, path: str) -> None:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)
    target: asyncio.Future[int] = asyncio.get_running_loop().create_future()
    with open(path, "wb", buffering=0) as noted:
        server = await asyncio.start_server(functools.partial(serve, target, noted), "127.0.0.1", 0, ssl=context)
        print(server.sockets[0].getsockname()[1], flush=True)
        target.set_result(int(await asyncio.to_thread(sys.stdin.readline)))
        await server.serve_forever()


asyncio.run(main(*sys.argv[1:]))
