# wayfused: built from source; the image holds the server, the command line and the libraries they are linked to, nothing else.
#   docker build -f docker/server.Dockerfile -t wayfuse/server .
# The stage below is the same in server.Dockerfile and phone.Dockerfile, so that it is built once for both.
FROM debian:bookworm-slim AS build
RUN apt-get update && apt-get install -y --no-install-recommends g++ cmake ninja-build pkg-config libboost1.81-dev \
      nlohmann-json3-dev libeigen3-dev libsqlite3-dev libsodium-dev libssl-dev libhwy-dev libspdlog-dev libcli11-dev \
      libcurl4-openssl-dev libtomlplusplus-dev zlib1g-dev libgeos-dev libzip-dev busybox openssl ca-certificates
COPY . /source
RUN cmake -S /source -B /build -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DWAYFUSE_BUILD_TESTS=OFF \
 && cmake --build /build --target wayfused wayfuse wayfuse-phone \
 && strip /build/server/wayfused /build/admin/wayfuse /build/sdk/wayfuse-phone

FROM build AS root
RUN /source/docker/slim-root /image --user wayfuse:10001:/var/lib/wayfuse --shell --certificates \
      --contains libboost1.81-dev --contains nlohmann-json3-dev --contains libeigen3-dev --contains libcli11-dev \
      /build/server/wayfused=/usr/bin/wayfused /build/admin/wayfuse=/usr/bin/wayfuse

FROM scratch AS runtime
ARG VERSION=0.1.0
ARG REVISION=unknown
LABEL org.opencontainers.image.title="wayfused" \
      org.opencontainers.image.description="wayfuse positioning server" \
      org.opencontainers.image.version="$VERSION" \
      org.opencontainers.image.revision="$REVISION" \
      org.opencontainers.image.vendor="wayfuse" \
      org.opencontainers.image.licenses="MIT"
COPY --from=root /image/ /
COPY --from=root --chown=10001:10001 /image.home/ /var/lib/wayfuse/
USER 10001:10001
VOLUME /var/lib/wayfuse
EXPOSE 8420
ENV PATH=/usr/bin WAYFUSE_SERVER_DATA=/var/lib/wayfuse WAYFUSE_LISTEN_ADDRESS=0.0.0.0 WAYFUSE_LISTEN_PORT=8420 \
    WAYFUSE_SERVER=http://127.0.0.1:8420
HEALTHCHECK --interval=5s --timeout=3s --start-period=20s CMD ["/usr/bin/wayfuse", "status"]
STOPSIGNAL SIGTERM
ENTRYPOINT ["/usr/bin/wayfused"]
