# One image per service, from the repository's root:
#   docker build -f deploy/service.Dockerfile --build-arg SERVICE=som_classifier -t actum/som_classifier .
FROM python:3.11-slim-bookworm AS build
RUN python -m venv --without-pip /venv
WORKDIR /build
COPY pyproject.toml README.md LICENSE ./

# Dependencies first: this layer survives edits of the sources.
ARG SERVICE
# The dependencies' own tests are a third of their files, and every file counts where an engine copies whole images.
RUN mkdir shared services \
    && pip --python /venv/bin/python install --no-cache-dir ".[$(echo "${SERVICE}" | tr _ -)]" \
    && find /venv -type d -name tests -prune -exec rm -r {} +

# The service's own folder is enough, but not for actum_command, which stands above all others: SOURCES=services
ARG SOURCES=services/${SERVICE}
COPY shared shared
COPY ${SOURCES} ${SOURCES}
RUN pip --python /venv/bin/python install --no-cache-dir --no-deps --force-reinstall . \
    && printf '#!/bin/sh\nexec python -m %s "$@"\n' "${SERVICE}" > /venv/bin/actum-service \
    && chmod +x /venv/bin/actum-service

FROM python:3.11-slim-bookworm
# A named volume mounted at /models takes its owner from the image.
RUN useradd --system --uid 10001 --no-create-home actum \
    && install --directory --owner=actum /models
COPY --from=build /venv /venv
ENV PATH=/venv/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    OPENBLAS_NUM_THREADS=1 \
    ACTUM_HEALTH_FILE=/tmp/actum.health
USER actum
HEALTHCHECK --interval=5s --timeout=3s --start-period=15s --retries=3 CMD ["python", "-m", "actum.health"]
ENTRYPOINT ["actum-service"]
