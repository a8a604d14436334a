# One image per service, from the repository's root:
#   docker build -f deploy/service.Dockerfile --build-arg SERVICE=som_classifier -t actum/som_classifier .
# LOCK names the file of requirements/ to install; PACKAGES are Debian's libraries that these need.
# BASE may name the base image by its digest. Images share the layers of Python, of this package, and of equal locks.
ARG BASE=python:3.11-slim-bookworm

FROM ${BASE} AS builder
RUN apt-get update -qq && apt-get install --yes -qq --no-install-recommends binutils > /dev/null
ENV PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore

# Third-party packages. Wheels bring symbols for debuggers, 20 MB in zstandard alone, and what compilers and type
# checkers read. The libraries in folders *.libs are laid out by auditwheel, which strip would undo.
# A root that cannot be written keeps no bytecode, so it is compiled here; by hash, it is the same in every build.
FROM builder AS packages
ARG LOCK=service
COPY deploy/requirements/${LOCK}.txt /build/
RUN pip install --quiet --no-compile --no-deps --require-hashes -r /build/${LOCK}.txt --target /packages \
    && find /packages -depth \( -name test -o -name tests -o -name '*.pyi' -o -name '*.a' -o -name '*.h' \) -exec rm -r {} + \
    && find /packages -name '*.so' -not -path '*.libs/*' -exec strip --strip-unneeded {} + \
    && python -m compileall -q --invalidation-mode unchecked-hash /packages

# This package, with all services, and its compiled steps.
FROM builder AS actum
RUN apt-get install --yes -qq --no-install-recommends gcc libc6-dev > /dev/null
COPY . /build
RUN pip install --quiet --no-compile --require-hashes -r /build/deploy/requirements/build.txt \
    && pip install --quiet --no-compile --no-deps --no-build-isolation /build --target /actum \
    && python -m compileall -q --invalidation-mode unchecked-hash /actum

# What runs: Python, without what installs software, and without what nobody reads there.
# A named volume takes its owner from the folder in the image.
FROM builder AS python
ARG PACKAGES=""
RUN if [ -n "${PACKAGES}" ]; then apt-get install --yes -qq --no-install-recommends ${PACKAGES} > /dev/null; fi \
    && groupadd --gid 10001 actum \
    && useradd --uid 10001 --gid actum --no-create-home actum \
    && install --directory --owner=actum /history /models /state \
    && cd /usr/local/lib/python3.11 \
    && rm -rf site-packages/* config-3.11* distutils ensurepip idlelib lib2to3 pydoc_data tkinter turtledemo \
    && rm -rf /usr/local/bin/pip* /usr/local/include \
    && find /usr/local/lib -name '*.so*' -type f -exec strip --strip-unneeded {} + \
    && python -m compileall -q --invalidation-mode unchecked-hash . \
    && apt-get purge --yes -qq --auto-remove binutils > /dev/null \
    && dpkg --purge --force-all apt libapt-pkg6.0 gpgv libgnutls30 libhogweed6 libnettle8 libp11-kit0 perl-base > /dev/null 2>&1 \
    && rm -rf /usr/share/doc /usr/share/info /usr/share/locale /usr/share/man /usr/lib/*/gconv \
    && rm -rf /var/cache/* /var/log/* /var/lib/apt

FROM scratch
COPY --from=python / /
COPY --from=packages /packages /packages
COPY --from=actum /actum /actum
ARG SERVICE
ENV PATH=/actum/bin:/usr/local/bin:/usr/bin:/bin \
    PYTHONPATH=/actum:/packages \
    PYTHONUNBUFFERED=1 \
    PYTHONDONTWRITEBYTECODE=1 \
    LANG=C.UTF-8 \
    OPENBLAS_NUM_THREADS=1 \
    MALLOC_ARENA_MAX=1 \
    MPLCONFIGDIR=/tmp/matplotlib \
    ACTUM_HEALTH_FILE=/tmp/actum.health \
    SERVICE=${SERVICE}
USER actum
# Each check costs 0.07 s of a core, so it is asked as seldom as lets a service be healthy within 5 s of its start.
HEALTHCHECK --interval=4s --timeout=3s --start-period=15s --retries=3 CMD ["python", "-SI", "/actum/actum/health.py"]
ENTRYPOINT ["sh", "-c", "exec python -m \"$SERVICE\" \"$@\"", "--"]
