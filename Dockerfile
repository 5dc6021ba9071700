# stickslip on Debian 12: built in one stage as its Debian package, installed in another.
#
#   docker build -t stickslip .
#   docker run --rm --user "$(id -u):$(id -g)" -v "$PWD:/work" stickslip run /usr/share/stickslip/scenes/slider.json -o slider

FROM debian:12 AS build
SHELL ["/bin/bash", "-euo", "pipefail", "-c"]
WORKDIR /src
COPY tools tools
# git tells results the commit that they are of; dpkg-dev and file are what cpack needs.
RUN bash tools/install_dependencies.sh && apt-get install -y --no-install-recommends git dpkg-dev file
COPY . .
RUN . tools/environment.sh \
  && cmake --preset release -DSTICKSLIP_BUILD_TESTS=OFF -DSTICKSLIP_BUILD_BENCH=OFF \
  && cmake --build --preset release -j "$jobs" \
  && cd build/release && cpack

FROM debian:12-slim
COPY --from=build /src/build/release/stickslip_*.deb /tmp/
# OpenBLAS first, so that it and no slower BLAS is what the package finds.
RUN apt-get update \
  && apt-get install -y --no-install-recommends libopenblas0-serial \
  && apt-get install -y --no-install-recommends /tmp/stickslip_*.deb \
  && rm -rf /var/lib/apt/lists/* /tmp/stickslip_*.deb
WORKDIR /work
ENTRYPOINT ["stickslip"]
