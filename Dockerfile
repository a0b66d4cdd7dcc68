# evolvent in a container: docker build -t evolvent . && docker run --rm -v "$PWD:/cases" evolvent evolvent run case.yaml -o result.h5
FROM debian:bookworm-slim AS wheel
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates
COPY . /evolvent
RUN /evolvent/tools/build-wheel /dist

FROM debian:trixie-slim
RUN apt-get update && apt-get install -y --no-install-recommends python3-venv && rm -rf /var/lib/apt/lists/*
COPY requirements/run.lock /evolvent/
COPY --from=wheel /dist /evolvent
# Python packages as tested: those of the lock, then the wheel alone.
RUN python3 -m venv /opt/evolvent \
    && /opt/evolvent/bin/pip install --no-cache-dir --require-hashes -r /evolvent/run.lock \
    && /opt/evolvent/bin/pip install --no-cache-dir --no-deps /evolvent/*.whl \
    && rm -r /evolvent
ENV PATH=/opt/evolvent/bin:$PATH MPLBACKEND=Agg MPLCONFIGDIR=/tmp/matplotlib LC_ALL=C.UTF-8
WORKDIR /cases
CMD ["evolvent", "--help"]
