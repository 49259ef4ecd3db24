# wayfuse-phone: stand-in phones, with the command line beside them.
#   docker build -f docker/phone.Dockerfile -t wayfuse/phone .
FROM debian:bookworm-slim AS build
RUN apt-get update && apt-get install -y --no-install-recommends g++ cmake ninja-build pkg-config libboost1.81-dev \
      nlohmann-json3-dev libeigen3-dev libsqlite3-dev libsodium-dev libssl-dev libhwy-dev libspdlog-dev libcli11-dev \
      libcurl4-openssl-dev libtomlplusplus-dev zlib1g-dev
COPY . /source
RUN cmake -S /source -B /build -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DWAYFUSE_BUILD_TESTS=OFF \
 && cmake --build /build --target wayfuse-phone wayfuse \
 && strip /build/sdk/wayfuse-phone /build/admin/wayfuse

FROM debian:bookworm-slim AS runtime
LABEL org.opencontainers.image.title="wayfuse-phone" \
      org.opencontainers.image.description="stand-in phones for wayfuse" \
      org.opencontainers.image.licenses="MIT"
RUN apt-get update \
 && apt-get install -y --no-install-recommends libssl3 libcurl4 ca-certificates \
 && rm -rf /var/lib/apt/lists/* /usr/share/doc /usr/share/man \
 && useradd --system --uid 10001 wayfuse
COPY --from=build /build/sdk/wayfuse-phone /build/admin/wayfuse /usr/bin/
COPY --from=build /source/docker/survey-and-walk /usr/bin/
USER wayfuse
ENTRYPOINT ["/usr/bin/wayfuse-phone"]
