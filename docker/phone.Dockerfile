# wayfuse-phone: stand-in phones, with the command line beside them.
#   docker build -f docker/phone.Dockerfile -t wayfuse/phone .
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
      --contains libboost1.81-dev --contains nlohmann-json3-dev --contains libcli11-dev \
      /build/sdk/wayfuse-phone=/usr/bin/wayfuse-phone /build/admin/wayfuse=/usr/bin/wayfuse \
      /source/docker/survey-and-walk=/usr/bin/survey-and-walk

FROM scratch AS runtime
ARG VERSION=0.1.0
ARG REVISION=unknown
LABEL org.opencontainers.image.title="wayfuse-phone" \
      org.opencontainers.image.description="stand-in phones for wayfuse" \
      org.opencontainers.image.version="$VERSION" \
      org.opencontainers.image.revision="$REVISION" \
      org.opencontainers.image.vendor="wayfuse" \
      org.opencontainers.image.licenses="MIT"
COPY --from=root /image/ /
COPY --from=root --chown=10001:10001 /image.home/ /var/lib/wayfuse/
USER 10001:10001
ENV PATH=/usr/bin
STOPSIGNAL SIGTERM
ENTRYPOINT ["/usr/bin/wayfuse-phone"]
