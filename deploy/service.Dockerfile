# One image per service, from the repository's root:
#   docker build -f deploy/service.Dockerfile --build-arg SERVICE=som_classifier -t actum/som_classifier .
# EXTRA installs other dependencies than the service's usual ones, PACKAGES adds Debian's libraries for them.
FROM python:3.11-slim-bookworm AS build
RUN python -m venv --without-pip /venv
WORKDIR /build
COPY pyproject.toml README.md LICENSE ./

# Dependencies first: this layer survives edits of the sources.
ARG SERVICE
ARG EXTRA=""
# MediaPipe brings an OpenCV with windows, which needs 220 MB of Debian's libraries; the one without does as well.
# The dependencies' own tests are a third of their files, and every file counts where an engine copies whole images.
RUN mkdir shared services \
    && pip --python /venv/bin/python install --no-cache-dir ".[${EXTRA:-$(echo "${SERVICE}" | tr _ -)}]" \
    && if [ -d /venv/lib/python3.11/site-packages/mediapipe ]; then \
         pip --python /venv/bin/python uninstall --yes opencv-contrib-python \
         && pip --python /venv/bin/python install --no-cache-dir --no-deps --force-reinstall opencv-python-headless; \
       fi \
    && find /venv -type d -name tests -prune -exec rm -r {} +

# The service's own folder is enough, but not for actum_command, which stands above all others: SOURCES=services
ARG SOURCES=services/${SERVICE}
COPY shared shared
COPY ${SOURCES} ${SOURCES}
RUN pip --python /venv/bin/python install --no-cache-dir --no-deps --force-reinstall . \
    && printf '#!/bin/sh\nexec python -m %s "$@"\n' "${SERVICE}" > /venv/bin/actum-service \
    && chmod +x /venv/bin/actum-service

FROM python:3.11-slim-bookworm
ARG PACKAGES=""
RUN if [ -n "${PACKAGES}" ]; then \
      apt-get update -qq && apt-get install --yes -qq --no-install-recommends ${PACKAGES} && rm -r /var/lib/apt/lists/*; \
    fi
# A named volume mounted at /models takes its owner from the image.
RUN useradd --system --uid 10001 --no-create-home actum \
    && install --directory --owner=actum /models
COPY --from=build /venv /venv
ENV PATH=/venv/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    OPENBLAS_NUM_THREADS=1 \
    MPLCONFIGDIR=/tmp/matplotlib \
    ACTUM_HEALTH_FILE=/tmp/actum.health
USER actum
HEALTHCHECK --interval=5s --timeout=3s --start-period=15s --retries=3 CMD ["python", "-m", "actum.health"]
ENTRYPOINT ["actum-service"]
