# Prometheus from Debian's own package, so that the composition needs one base image and nothing else.
#   docker build -f docker/prometheus.Dockerfile -t wayfuse/prometheus .
FROM debian:bookworm-slim AS root
RUN apt-get update && apt-get install -y --no-install-recommends prometheus busybox ca-certificates openssl
COPY docker/slim-root /usr/local/bin/
RUN slim-root /image --user prometheus:10001:/var/lib/prometheus --shell --certificates /usr/bin/prometheus /usr/bin/promtool

FROM scratch AS runtime
LABEL org.opencontainers.image.title="prometheus" \
      org.opencontainers.image.description="Debian's Prometheus, as wayfuse's composition runs it" \
      org.opencontainers.image.licenses="Apache-2.0"
COPY --from=root /image/ /
COPY --from=root --chown=10001:10001 /image.home/ /var/lib/prometheus/
USER 10001:10001
ENV PATH=/usr/bin
VOLUME /var/lib/prometheus
EXPOSE 9090
ENTRYPOINT ["/usr/bin/prometheus"]
CMD ["--config.file=/etc/prometheus/prometheus.yml", "--storage.tsdb.path=/var/lib/prometheus"]
