# One image per service, from the repository's root:
#   docker build -f deploy/service.Dockerfile --build-arg SERVICE=som_classifier -t actum/som_classifier .
# LOCK names the file of requirements/ to install; PACKAGES are Debian's libraries that these need.
# BASE may name the base image by its digest.
ARG BASE=python:3.11-slim-bookworm

# Third-party packages; images with the same lock file share this layer.
FROM ${BASE} AS packages
RUN apt-get update -qq && apt-get install --yes -qq --no-install-recommends binutils > /dev/null
ENV PIP_NO_CACHE_DIR=1 PIP_NO_COMPILE=1 PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore
WORKDIR /build
ARG LOCK=service
COPY deploy/requirements/build.txt deploy/requirements/${LOCK}.txt ./
# Wheels bring symbols for debuggers, 20 MB in zstandard alone, and what compilers and type checkers read. The libraries
# in folders *.libs are laid out by auditwheel, which strip would undo.
# A root that cannot be written keeps no bytecode, so it is compiled here; by hash, it is the same in every build.
RUN pip install --quiet --require-hashes -r build.txt \
    && pip install --quiet --no-deps --require-hashes -r ${LOCK}.txt --target /packages \
    && find /packages -depth \( -name tests -o -name '*.pyi' -o -name '*.a' -o -name '*.h' \) -exec rm -r {} + \
    && find /packages -name '*.so' -not -path '*.libs/*' -exec strip --strip-unneeded {} + \
    && python -m compileall -q --invalidation-mode unchecked-hash /packages

# The service itself. Its own folder is enough, but not for actum_command, which stands above all: SOURCES=services
FROM packages AS program
ARG SERVICE
ARG SOURCES=services/${SERVICE}
COPY pyproject.toml README.md LICENSE ./
COPY shared shared
COPY ${SOURCES} ${SOURCES}
RUN pip install --quiet --no-deps --no-build-isolation . --target /actum \
    && python -m compileall -q --invalidation-mode unchecked-hash /actum \
    && printf '#!/bin/sh\nexec python -m %s "$@"\n' "${SERVICE}" > /actum/bin/actum-service \
    && chmod +x /actum/bin/actum-service

# What runs: Python, without what installs software, and without what nobody reads there.
FROM ${BASE} AS python
ARG PACKAGES=""
# A named volume takes its owner from the folder in the image.
RUN apt-get update -qq && apt-get install --yes -qq --no-install-recommends binutils ${PACKAGES} > /dev/null \
    && groupadd --system --gid 10001 actum \
    && useradd --system --uid 10001 --gid 10001 --no-create-home actum \
    && install --directory --owner=actum /models /state \
    && cd /usr/local/lib/python3.11 \
    && rm -rf site-packages/* config-3.11* distutils ensurepip idlelib lib2to3 pydoc_data tkinter turtledemo \
    && rm -rf /usr/local/bin/pip* /usr/local/include \
    && find /usr/local/lib -name '*.so*' -type f -exec strip --strip-unneeded {} + \
    && python -m compileall -q --invalidation-mode unchecked-hash . \
    && apt-get purge --yes -qq --auto-remove binutils > /dev/null \
    && dpkg --purge --force-all apt libapt-pkg6.0 gpgv perl-base 2> /dev/null \
    && rm -rf /usr/share/doc /usr/share/info /usr/share/locale /usr/share/man /usr/lib/*/gconv \
    && rm -rf /var/cache/* /var/log/* /var/lib/apt

FROM scratch
COPY --from=python / /
COPY --from=packages /packages /packages
COPY --from=program /actum /actum
ENV PATH=/actum/bin:/usr/local/bin:/usr/bin:/bin \
    PYTHONPATH=/actum:/packages \
    PYTHONUNBUFFERED=1 \
    PYTHONDONTWRITEBYTECODE=1 \
    LANG=C.UTF-8 \
    OPENBLAS_NUM_THREADS=1 \
    MPLCONFIGDIR=/tmp/matplotlib \
    ACTUM_HEALTH_FILE=/tmp/actum.health
USER actum
# Each check costs 0.07 s of a core, so it is asked as seldom as lets a service be healthy within 5 s of its start.
HEALTHCHECK --interval=4s --timeout=3s --start-period=15s --retries=3 CMD ["python", "-SI", "/actum/actum/health.py"]
ENTRYPOINT ["actum-service"]
