"""The knowledge base on a Chroma server: written there once, read whole at the start of a session, scored here.

Scores are computed from what was read, so a server changes where experiences are kept and nothing of what is retrieved.
"""

from __future__ import annotations

import logging
from typing import Any
from urllib.parse import urlsplit

from pydantic import ValidationError

from kb.errors import BadInputError, EnvironmentFaultError
from kb.experience import Experience
from kb.store import ExperienceStore
from kb.store_file import StoreHeader

COLLECTION = "ragvlm_experiences"
PAGE = 500
"""Entries per request."""


def write_server(store: ExperienceStore, url: str) -> int:
    """Puts every entry of `store` on the server in place of what was there; returns how many.

    Raises:
        BadInputError: the address is none.
        EnvironmentFaultError: the server cannot be reached.
    """
    client = _client(url)
    try:
        if COLLECTION in [collection.name for collection in client.list_collections()]:
            client.delete_collection(COLLECTION)
        collection = client.create_collection(
            COLLECTION,
            embedding_function=None,
            metadata={"hnsw:space": "cosine", "header": store.header.model_dump_json()},
        )
        entries = store.all()
        for start in range(0, len(entries), PAGE):
            page = entries[start : start + PAGE]
            collection.add(
                ids=[entry.id for entry in page],
                embeddings=[list(entry.embedding) for entry in page],
                documents=[entry.model_dump_json(exclude={"embedding"}) for entry in page],
                metadatas=[{"category": entry.category, "place": start + i} for i, entry in enumerate(page)],
            )
    except Exception as error:  # the client passes on whatever its transport raises
        raise _unusable(url, error) from error
    return len(entries)


def read_server(url: str) -> ExperienceStore:
    """The server's knowledge base, in memory.

    Raises:
        BadInputError: the address is none, or what is there is damaged.
        EnvironmentFaultError: the server cannot be reached, or holds no knowledge base.
    """
    client = _client(url)
    try:
        if COLLECTION not in [collection.name for collection in client.list_collections()]:
            raise EnvironmentFaultError(
                f"the server {url} holds no knowledge base", mend=f"put one there: ragvlm kb push --kb-url {url}"
            )
        collection = client.get_collection(COLLECTION, embedding_function=None)
        rows: list[tuple[int, str, list[float]]] = []
        for start in range(0, collection.count(), PAGE):
            page = collection.get(limit=PAGE, offset=start, include=["embeddings", "documents", "metadatas"])
            for document, vector, facts in zip(page["documents"], page["embeddings"], page["metadatas"], strict=True):
                # The server keeps single precision; the file's six decimals are within that.
                rows.append((int(facts["place"]), document, [round(float(value), 6) for value in vector]))
    except EnvironmentFaultError:
        raise
    except Exception as error:
        raise _unusable(url, error) from error
    return _store(url, str(collection.metadata.get("header")), rows)


def _store(url: str, header: str, rows: list[tuple[int, str, list[float]]]) -> ExperienceStore:
    try:
        entries: list[Experience] = []
        for _, document, vector in sorted(rows, key=lambda row: row[0]):
            without = document.rstrip().removesuffix("}")
            entries.append(Experience.model_validate_json(f'{without}, "embedding": {vector}}}'))
        return ExperienceStore(StoreHeader.model_validate_json(header), entries)
    except ValidationError as error:
        field = ".".join(str(part) for part in error.errors(include_url=False)[0]["loc"])
        raise BadInputError(
            f"the knowledge base there is damaged or of another version ({field})", where=url
        ) from error


def _client(url: str) -> Any:
    """A client of the server.

    Raises:
        BadInputError: the address is none.
        EnvironmentFaultError: nobody answers there.
    """
    parts = urlsplit(url)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise BadInputError(f'"{url}" is no address', where="--kb-url", choices=("http://HOST:PORT",))
    logging.getLogger("httpx").setLevel(logging.WARNING)  # one line a request is no one's business
    import chromadb
    from chromadb.config import Settings

    try:
        port = parts.port or (443 if parts.scheme == "https" else 80)
        return chromadb.HttpClient(
            host=parts.hostname, port=port, ssl=parts.scheme == "https", settings=Settings(anonymized_telemetry=False)
        )
    except Exception as error:
        raise _unusable(url, error) from error


def _unusable(url: str, error: Exception) -> EnvironmentFaultError:
    first = str(error).splitlines()[0][:200] if str(error) else type(error).__name__
    return EnvironmentFaultError(
        f"the Chroma server {url} cannot be used: {first}", mend="start one: chroma run --port 8000"
    )
