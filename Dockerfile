# Image with byre's packages: builds them as scripts/test_packages.sh --build does, and installs them on a bare Debian.
# Not run yet: no Docker was available when it was written; the chroot of scripts/test_packages.sh follows the same steps.
#   docker build -t byre .
#   docker run --rm --volume "$PWD:/data" --workdir /data byre map RECORDING -o barn.byre
# --build-arg RELEASE=trixie selects Debian 13.
ARG RELEASE=bookworm

FROM debian:${RELEASE}-slim AS build
COPY scripts/install-dependencies.sh /byre/scripts/
RUN /byre/scripts/install-dependencies.sh packages
COPY . /byre
WORKDIR /byre
RUN cmake --preset demo \
    && cmake --build --preset demo --target byre_packaged \
    && cpack --config build/demo/CPackConfig.cmake -B /packages \
    && rm -rf /packages/_CPack_Packages

FROM debian:${RELEASE}-slim
COPY --from=build /packages /packages
RUN apt-get update \
    && DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends \
       /packages/byre_*.deb /packages/byre-data_*.deb /packages/python3-byre_*.deb \
    && rm -rf /packages /var/lib/apt/lists/*
ENTRYPOINT ["byre"]
CMD ["--help"]
