# By tag until somebody with a network writes the digest here: docs/releasing.md has the command.
FROM python:3.13-slim AS build
RUN python -m venv --without-pip /venv
WORKDIR /source
# The dependencies first: this layer lasts until the lock changes.
COPY requirements.lock .
RUN pip --python /venv/bin/python install --no-cache-dir --require-hashes --requirement requirements.lock
COPY pyproject.toml hatch_build.py README.md LICENSE CITATION.cff ./
COPY app app
# The pages on words and ideas that the server shows.
COPY docs/*.md docs/
COPY hexapods hexapods
COPY models models
COPY static static
RUN pip --python /venv/bin/python install --no-cache-dir --no-deps --no-build-isolation . \
    # What only the build needed; tests/test_container.py compares it with what is installed.
    && pip --python /venv/bin/python uninstall --yes hatchling pathspec pluggy tomlkit trove-classifiers

FROM python:3.13-slim
# The version, the commit and the address are added where an image is published.
LABEL org.opencontainers.image.title="Racing Hexapods" \
    org.opencontainers.image.description="Hexapods learn to walk by Q-learning and race in the browser" \
    org.opencontainers.image.licenses="MIT"
# No installer in what runs: nothing is installed there.
RUN python -m pip uninstall --yes pip && rm -r /usr/local/lib/python3.13/ensurepip
# A fixed number, so that a data folder mounted from the host can be given to it.
RUN useradd --uid 10001 --user-group --home-dir /data --no-create-home hexapods \
    && install --directory --mode 0700 --owner hexapods --group hexapods /data
COPY --from=build /venv /venv
ENV PATH=/venv/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    HEXAPODS_HOST=0.0.0.0 \
    HEXAPODS_PORT=8000 \
    HEXAPODS_DATA=/data
USER hexapods
WORKDIR /data
VOLUME /data
EXPOSE 8000
HEALTHCHECK --interval=15s --timeout=5s --start-period=30s \
    CMD ["python", "-c", "import os, urllib.request as r; r.urlopen(f'http://127.0.0.1:{os.environ[\"HEXAPODS_PORT\"]}/healthz', timeout=4)"]
ENTRYPOINT ["hexapods"]
CMD ["serve"]
