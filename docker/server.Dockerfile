# wayfused: built from source, run from a slim image as an unprivileged user.
#   docker build -f docker/server.Dockerfile -t wayfuse/server .
FROM debian:bookworm-slim AS build
RUN apt-get update && apt-get install -y --no-install-recommends g++ cmake ninja-build pkg-config libboost1.81-dev \
      nlohmann-json3-dev libeigen3-dev libsqlite3-dev libsodium-dev libssl-dev libhwy-dev libspdlog-dev libcli11-dev \
      libcurl4-openssl-dev libtomlplusplus-dev zlib1g-dev
COPY . /source
RUN cmake -S /source -B /build -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DWAYFUSE_BUILD_TESTS=OFF \
 && cmake --build /build --target wayfused wayfuse \
 && strip /build/server/wayfused /build/admin/wayfuse

FROM debian:bookworm-slim AS runtime
LABEL org.opencontainers.image.title="wayfused" \
      org.opencontainers.image.description="wayfuse positioning server" \
      org.opencontainers.image.licenses="MIT"
RUN apt-get update \
 && apt-get install -y --no-install-recommends libsqlite3-0 libsodium23 libssl3 libhwy1 libspdlog1.10 libfmt9 libcurl4 libtomlplusplus3 ca-certificates openssl \
 && rm -rf /var/lib/apt/lists/* /usr/share/doc /usr/share/man \
 && useradd --system --uid 10001 --home-dir /var/lib/wayfuse --create-home wayfuse
COPY --from=build /build/server/wayfused /build/admin/wayfuse /usr/bin/
USER wayfuse
VOLUME /var/lib/wayfuse
EXPOSE 8420
ENV WAYFUSE_SERVER_DATA=/var/lib/wayfuse WAYFUSE_LISTEN_ADDRESS=0.0.0.0 WAYFUSE_LISTEN_PORT=8420 \
    WAYFUSE_SERVER=http://127.0.0.1:8420
HEALTHCHECK --interval=5s --timeout=3s --start-period=20s CMD ["/usr/bin/wayfuse", "status"]
STOPSIGNAL SIGTERM
ENTRYPOINT ["/usr/bin/wayfused"]
