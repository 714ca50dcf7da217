FROM python:3.13-slim AS build
RUN python -m venv /venv
WORKDIR /source
# The dependencies first: this layer lasts until the lock changes.
COPY requirements.lock .
RUN /venv/bin/pip install --no-cache-dir --require-hashes --requirement requirements.lock
COPY pyproject.toml hatch_build.py README.md LICENSE CITATION.cff ./
COPY app app
# The pages on words and ideas that the server shows.
COPY docs/*.md docs/
COPY hexapods hexapods
COPY models models
COPY static static
RUN /venv/bin/pip install --no-cache-dir --no-deps --no-build-isolation .

FROM python:3.13-slim
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
