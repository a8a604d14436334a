/* The steps that run for every frame, compiled: the same operations in the same order as the NumPy code beside which
   each is called. Arrays are C-contiguous; who calls has checked their shapes. */

#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030b0000
#include <Python.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__)
#define VECTORISED __attribute__((target_clones("avx2", "default"))) /* the processor's own width, chosen at run time */
#else
#define VECTORISED
#endif

enum { SIDES = 2, CHANNELS = 4, JOINTS = 15, COORDINATES = 45, PARTS = 5, LIMBS = 4, MOMENTS = 8, MOST_INSTANTS = 64 };

/* Release the buffers that were taken, and return None, or NULL where an error is set. */
static PyObject *released(Py_buffer *buffers, int count)
{
    while (count-- > 0)
        PyBuffer_Release(&buffers[count]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

/* The instants, as fractional frame numbers, at which a segment reaches the progress asked for: np.interp of rising
   `reached`, which is half time and half way. */
static double instant_of(double progress, const int64_t *travelled_um, Py_ssize_t frames)
{
    double begin = (double)travelled_um[0], moved = (double)travelled_um[frames] - begin;
    double per_frame = moved > 0 ? 0.5 / (double)frames : 1.0 / (double)frames, per_um = moved > 0 ? 0.5 / moved : 0.0;
    Py_ssize_t low = 0, high = frames;
#define REACHED(k) (per_frame * (double)(k) + per_um * ((double)travelled_um[k] - begin))
    if (progress >= REACHED(frames))
        return (double)frames;
    if (progress < REACHED(0))
        return 0.0;
    while (high - low > 1) {
        Py_ssize_t middle = (low + high) / 2;
        if (progress >= REACHED(middle))
            low = middle;
        else
            high = middle;
    }
    double before = REACHED(low);
    return 1.0 / (REACHED(low + 1) - before) * (progress - before) + (double)low;
#undef REACHED
}

/* One border's sum since the segment's start, between two frames by its share of the second. */
VECTORISED static void sum_at_border(
    const uint32_t *start, const uint32_t *below, const uint32_t *above, float share, float *out, Py_ssize_t units)
{
    for (Py_ssize_t u = 0; u < units; u++) {
        float before = (float)(below[u] - start[u]);
        out[u] = before + ((float)(above[u] - start[u]) - before) * share;
    }
}

VECTORISED static void fourth_root_of_mean(const float *begin, const float *end, float length, float *out, Py_ssize_t units)
{
    for (Py_ssize_t u = 0; u < units; u++)
        out[u] = sqrtf(sqrtf((end[u] - begin[u]) / length));
}

PyDoc_STRVAR(pooled_doc,
    "pooled(sums, travelled_um, borders, begins, ends, scale, out)\n--\n\n"
    "Write the fourth root of each cell's mean activity, (cells * units,), of a segment's prefix sums.");
static PyObject *pooled(PyObject *module, PyObject *args)
{
    PyObject *sums;
    Py_buffer b[5];
    double scale;
    if (!PyArg_ParseTuple(args, "O!y*y*y*y*dw*", &PyList_Type, &sums, &b[0], &b[1], &b[2], &b[3], &scale, &b[4]))
        return NULL;
    const int64_t *travelled_um = b[0].buf;
    const double *borders = b[1].buf;
    const int32_t *begins = b[2].buf, *ends = b[3].buf;
    float *out = b[4].buf;
    Py_ssize_t frames = b[0].len / 8 - 1, count = b[1].len / 8, cells = b[2].len / 4, units = b[4].len / 4 / cells;
    double *at = PyMem_Malloc(count * sizeof(double));
    float *at_border = PyMem_Malloc(count * units * sizeof(float));
    if (at == NULL || at_border == NULL)
        PyErr_NoMemory();
    else if (PyList_Size(sums) != frames + 1 || frames < 1)
        PyErr_SetString(PyExc_ValueError, "the sums are not as many as the frames and one");
    for (Py_ssize_t k = 0; k < count && !PyErr_Occurred(); k++) {
        Py_buffer row[3];
        at[k] = instant_of(borders[k], travelled_um, frames);
        Py_ssize_t below = (Py_ssize_t)at[k], n = 0;
        if (below > frames - 1)
            below = frames - 1;
        const Py_ssize_t rows[3] = {0, below, below + 1};
        while (n < 3 && PyObject_GetBuffer(PyList_GetItem(sums, rows[n]), &row[n], PyBUF_SIMPLE) == 0)
            n++;
        if (n == 3 && (row[0].len != units * 4 || row[1].len != units * 4 || row[2].len != units * 4))
            PyErr_SetString(PyExc_ValueError, "the sums are not of the length of a cell");
        else if (n == 3)
            sum_at_border(row[0].buf, row[1].buf, row[2].buf, (float)(at[k] - (double)below), at_border + k * units, units);
        while (n-- > 0)
            PyBuffer_Release(&row[n]);
    }
    for (Py_ssize_t c = 0; c < cells && !PyErr_Occurred(); c++) {
        float length = (float)((at[ends[c]] - at[begins[c]]) * scale);
        fourth_root_of_mean(at_border + begins[c] * units, at_border + ends[c] * units, length, out + c * units, units);
    }
    PyMem_Free(at);
    PyMem_Free(at_border);
    return released(b, 5);
}

/* NumPy's pairwise sum of contiguous numbers. */
static float pairwise_sum(const float *x, Py_ssize_t n)
{
    if (n < 8) {
        float sum = -0.0f;
        for (Py_ssize_t i = 0; i < n; i++)
            sum += x[i];
        return sum;
    }
    if (n > 128) {
        Py_ssize_t half = n / 2;
        half -= half % 8;
        return pairwise_sum(x, half) + pairwise_sum(x + half, n - half);
    }
    float r[8];
    Py_ssize_t i;
    memcpy(r, x, sizeof r);
    for (i = 8; i < n - n % 8; i += 8)
        for (int k = 0; k < 8; k++)
            r[k] += x[i + k];
    float sum = ((r[0] + r[1]) + (r[2] + r[3])) + ((r[4] + r[5]) + (r[6] + r[7]));
    for (; i < n; i++)
        sum += x[i];
    return sum;
}

PyDoc_STRVAR(map_inputs_doc,
    "map_inputs(posture, velocity, mirror, signs, minuend, subtrahend, weights, centre, out)\n--\n\n"
    "Write what the maps are shown of a frame and of its mirror image, relative to their centres, (2, inputs).");
static PyObject *map_inputs(PyObject *module, PyObject *args)
{
    Py_buffer b[9];
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*y*y*y*w*", &b[0], &b[1], &b[2], &b[3], &b[4], &b[5], &b[6], &b[7], &b[8]))
        return NULL;
    const int32_t *mirror = b[2].buf, *minuend = b[4].buf, *subtrahend = b[5].buf;
    const double *signs = b[3].buf, *weights = b[6].buf;
    const float *centre = b[7].buf;
    float *out = b[8].buf;
    double row[SIDES][2 * COORDINATES];
    memcpy(row[0], b[0].buf, sizeof row[0] / 2);
    memcpy(row[0] + COORDINATES, b[1].buf, sizeof row[0] / 2);
    for (int i = 0; i < 2 * COORDINATES; i++)
        row[1][i] = row[0][mirror[i]] * signs[i];
    Py_ssize_t inputs = b[7].len / sizeof(float);
    for (int side = 0; side < SIDES; side++)
        for (Py_ssize_t i = 0; i < inputs; i++) {
            double value = row[side][minuend[i]];
            if (subtrahend[i] >= 0)
                value = (value - row[side][subtrahend[i]]) * weights[i];
            out[side * inputs + i] = (float)(value - (double)centre[i]);
        }
    return released(b, 9);
}

VECTORISED static float least_of_sums(const float *scores, const float *half_norms2, float *sums, Py_ssize_t units)
{
    float least = INFINITY;
    for (Py_ssize_t u = 0; u < units; u++) {
        sums[u] = scores[u] + half_norms2[u];
        least = sums[u] < least ? sums[u] : least;
    }
    return least;
}

VECTORISED static void scaled_excess(const float *sums, float least, float slope, float *out, Py_ssize_t units)
{
    for (Py_ssize_t u = 0; u < units; u++)
        out[u] = (sums[u] - least) * 2 * slope;
}

PyDoc_STRVAR(exponents_doc,
    "exponents(scores, half_norms2, maps, sides, slopes, out)\n--\n\n"
    "Write the exponents of a frame's activities, as seen and mirrored, (2, channels * units), from its scores.");
static PyObject *exponents(PyObject *module, PyObject *args)
{
    Py_buffer b[6];
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*w*", &b[0], &b[1], &b[2], &b[3], &b[4], &b[5]))
        return NULL;
    const float *scores = b[0].buf, *half_norms2 = b[1].buf, *slopes = b[4].buf;
    const int32_t *maps = b[2].buf, *sides = b[3].buf;
    float *out = b[5].buf;
    Py_ssize_t units = b[5].len / (Py_ssize_t)sizeof(float) / SIDES / CHANNELS;
    Py_ssize_t width = b[1].len / (Py_ssize_t)sizeof(float);
    float *sums = PyMem_Malloc(units * sizeof(float));
    if (sums == NULL)
        PyErr_NoMemory();
    for (int block = 0; block < SIDES * CHANNELS && sums != NULL; block++) {
        int channel = block % CHANNELS, side = block / CHANNELS ^ sides[channel];
        Py_ssize_t first = maps[channel] * units;
        float least = least_of_sums(scores + side * width + first, half_norms2 + first, sums, units);
        scaled_excess(sums, least, slopes[channel], out + block * units, units);
    }
    PyMem_Free(sums);
    return released(b, 6);
}

VECTORISED static void add_quantised(
    const float *activity, float factor, float scale, const uint32_t *before, uint32_t *after, Py_ssize_t units)
{
    for (Py_ssize_t u = 0; u < units; u++)
        after[u] = before[u] + (uint32_t)(int32_t)rintf(activity[u] * factor * scale);
}

static Py_ssize_t first_largest(const float *x, Py_ssize_t n)
{
    Py_ssize_t largest = 0;
    for (Py_ssize_t i = 1; i < n; i++)
        if (x[i] > x[largest])
            largest = i;
    return largest;
}

PyDoc_STRVAR(accumulated_doc,
    "accumulated(activities, shares, scale, before, after, winners)\n--\n\n"
    "Add a frame's normalised activities, quantised, to the sums before it, (2, channels * units); find its winners.");
static PyObject *accumulated(PyObject *module, PyObject *args)
{
    Py_buffer b[5];
    float scale;
    if (!PyArg_ParseTuple(args, "y*y*fy*w*w*", &b[0], &b[1], &scale, &b[2], &b[3], &b[4]))
        return NULL;
    const float *activities = b[0].buf, *shares = b[1].buf;
    const uint32_t *before = b[2].buf;
    uint32_t *after = b[3].buf;
    int64_t *winners = b[4].buf;
    Py_ssize_t units = b[0].len / (Py_ssize_t)sizeof(float) / SIDES / CHANNELS;
    for (int block = 0; block < SIDES * CHANNELS; block++) {
        const float *activity = activities + block * units;
        float factor = shares[block % CHANNELS] / pairwise_sum(activity, units);
        add_quantised(activity, factor, scale, before + block * units, after + block * units, units);
        if (block % CHANNELS == 0)
            winners[block / CHANNELS] = first_largest(activity, units);
    }
    return released(b, 5);
}

/* log(d²) of the posture map's quantization error, d in metres; numbers are added up as NumPy adds 45. */
static double log_error(const double *posture, const float *unit, double smallest2)
{
    double r[8] = {0}, sum;
    for (int i = 0; i < COORDINATES; i++) {
        double error = posture[i] - (double)unit[i];
        if (i < COORDINATES - COORDINATES % 8)
            r[i % 8] += error * error;
    }
    sum = ((r[0] + r[1]) + (r[2] + r[3])) + ((r[4] + r[5]) + (r[6] + r[7]));
    for (int i = COORDINATES - COORDINATES % 8; i < COORDINATES; i++) {
        double error = posture[i] - (double)unit[i];
        sum += error * error;
    }
    double error2 = sum / COORDINATES * COORDINATES;
    return log(error2 > smallest2 ? error2 : smallest2);
}

PyDoc_STRVAR(totals_doc,
    "totals(before, motion, posture, mirror, signs, units, winners, limbs, smallest2, after)\n--\n\n"
    "Write a frame's totals: displacements (um), moments of the limbs (mm), missing joints, log errors (millionths).");
static PyObject *totals(PyObject *module, PyObject *args)
{
    Py_buffer b[9];
    double smallest2;
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*y*y*y*dw*", &b[0], &b[1], &b[2], &b[3], &b[4], &b[5], &b[6], &b[7],
                          &smallest2, &b[8]))
        return NULL;
    const double *motion = b[1].buf, *posture = b[2].buf, *signs = b[4].buf;
    const int32_t *mirror = b[3].buf, *limbs = b[7].buf;
    const int64_t *winners = b[6].buf;
    const float *units = b[5].buf;
    int64_t *after = b[8].buf, *moments = after + PARTS, *errors = after + PARTS + LIMBS * MOMENTS + 1;
    double image[COORDINATES];
    memcpy(after, b[0].buf, b[8].len);
    for (int part = 0; part < PARTS; part++)
        after[part] += (int64_t)rint(motion[part] * 1e6);
    for (int limb = 0; limb < LIMBS; limb++) {
        int64_t squares = 0;
        for (int i = 0; i < MOMENTS - 2; i++) {
            int64_t mm = (int64_t)rint(posture[limbs[limb * (MOMENTS - 2) + i]] * 1000);
            moments[limb * MOMENTS + i] += mm;
            squares += mm * mm;
        }
        moments[limb * MOMENTS + MOMENTS - 2] += squares;
        moments[limb * MOMENTS + MOMENTS - 1] += 1;
    }
    for (int i = 0; i < COORDINATES; i++)
        image[i] = posture[mirror[i]] * signs[i];
    errors[0] += (int64_t)rint(log_error(posture, units + winners[0] * COORDINATES, smallest2) * 1e6);
    errors[1] += (int64_t)rint(log_error(image, units + winners[1] * COORDINATES, smallest2) * 1e6);
    return released(b, 9);
}

PyDoc_STRVAR(smoothed_doc,
    "smoothed(joints, before, speed, smooth, lagging, elapsed_s, gain, still_s, still_mps, lag_s, decay, out)\n--\n\n"
    "Advance the kinematics of all joints: write speeds, smooth and lagging positions, velocities, (4, 15, 3).");
static PyObject *smoothed(PyObject *module, PyObject *args)
{
    Py_buffer b[6];
    double elapsed_s, gain, still_s, still_mps, lag_s, decay;
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*ddddddw*", &b[0], &b[1], &b[2], &b[3], &b[4], &elapsed_s, &gain, &still_s,
                          &still_mps, &lag_s, &decay, &b[5]))
        return NULL;
    const double *joints = b[0].buf, *before = b[1].buf, *speed = b[2].buf, *smooth = b[3].buf, *lagging = b[4].buf;
    double *out = b[5].buf;
    for (int joint = 0; joint < JOINTS; joint++) {
        double speed2 = 0.0;
        for (int i = 3 * joint; i < 3 * joint + 3; i++) {
            out[i] = speed[i] + gain * ((joints[i] - before[i]) / elapsed_s - speed[i]);
            speed2 += out[i] * out[i];
        }
        double share = 1 - exp(elapsed_s / -still_s * (1 + sqrt(speed2) / still_mps));
        for (int i = 3 * joint; i < 3 * joint + 3; i++) {
            double step = share * (joints[i] - smooth[i]), behind = lag_s / elapsed_s * step;
            out[COORDINATES + i] = smooth[i] + step;
            out[2 * COORDINATES + i] = smooth[i] + step - behind + (lagging[i] - smooth[i] + behind) * decay;
            out[3 * COORDINATES + i] = out[COORDINATES + i] - out[2 * COORDINATES + i];
        }
    }
    return released(b, 6);
}

static double length3(const double *v) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

static int unit3(const double *v, double shortest, double *out)
{
    double length = length3(v);
    for (int i = 0; i < 3; i++)
        out[i] = v[i] / length;
    return length >= shortest;
}

/* The egocentric frame (4, 4) of joints (15, 3), as geometry.ego_from_camera builds it; 0 where it is not defined. */
static int ego_from_camera(const double *joints, const int32_t *hips_torso, double shortest, double *ego)
{
    const double *right = joints + 3 * hips_torso[0], *left = joints + 3 * hips_torso[1];
    const double *torso = joints + 3 * hips_torso[2];
    double across[3], trunk[3], origin[3], along = 0.0;
    for (int i = 0; i < 3; i++)
        across[i] = left[i] - right[i];
    memset(ego, 0, 16 * sizeof *ego);
    double *x = ego, *y = ego + 4, *z = ego + 8;
    if (!unit3(across, shortest, x))
        return 0;
    for (int i = 0; i < 3; i++)
        along += (torso[i] - right[i]) * x[i];
    for (int i = 0; i < 3; i++) {
        origin[i] = right[i] + along * x[i];
        trunk[i] = torso[i] - origin[i];
    }
    if (!unit3(trunk, shortest, y))
        return 0;
    for (int i = 0; i < 3; i++)
        z[i] = x[(i + 1) % 3] * y[(i + 2) % 3] - x[(i + 2) % 3] * y[(i + 1) % 3];
    for (int row = 0; row < 3; row++)
        ego[4 * row + 3] = -(ego[4 * row] * origin[0] + ego[4 * row + 1] * origin[1] + ego[4 * row + 2] * origin[2]);
    ego[15] = 1.0;
    return 1;
}

static void apply(const double *transform, const double *joints, double *out)
{
    for (int joint = 0; joint < JOINTS; joint++, joints += 3)
        for (int row = 0; row < 3; row++, out++)
            *out = transform[4 * row] * joints[0] + transform[4 * row + 1] * joints[1] + transform[4 * row + 2] * joints[2]
                + transform[4 * row + 3];
}

/* Read a message's joints, a list of fifteen lists of three numbers, NaN where one is unknown (None). Return how many
   are unknown, -1 where an error is set. */
static int read_joints(PyObject *joints, double *out)
{
    int unknown = 0;
    if (!PyList_Check(joints) || PyList_Size(joints) != JOINTS) {
        PyErr_SetString(PyExc_ValueError, "the joints are not a list of fifteen");
        return -1;
    }
    for (int joint = 0; joint < JOINTS; joint++) {
        PyObject *point = PyList_GetItem(joints, joint);
        int known = point != Py_None;
        if (known && (!PyList_Check(point) || PyList_Size(point) != 3)) {
            PyErr_SetString(PyExc_ValueError, "a joint is not a list of three numbers");
            return -1;
        }
        unknown += !known;
        for (int i = 0; i < 3; i++)
            *out++ = known ? PyFloat_AsDouble(PyList_GetItem(point, i)) : NAN;
    }
    return PyErr_Occurred() ? -1 : unknown;
}

static PyObject *listed(const double *numbers, int count)
{
    PyObject *list = PyList_New(count);
    for (int i = 0; list != NULL && i < count; i++) {
        PyObject *number = PyFloat_FromDouble(numbers[i]);
        if (number == NULL)
            Py_CLEAR(list);
        else
            PyList_SetItem(list, i, number);
    }
    return list;
}

static PyObject *listed_joints(const double *joints)
{
    PyObject *list = PyList_New(JOINTS);
    for (int joint = 0; list != NULL && joint < JOINTS; joint++) {
        PyObject *point = listed(joints + 3 * joint, 3);
        if (point == NULL)
            Py_CLEAR(list);
        else
            PyList_SetItem(list, joint, point);
    }
    return list;
}

PyDoc_STRVAR(body_doc,
    "body(joints, parents, children, lengths_m, hips_torso, reach_m, bone_m, shortest_m, out) -> bool\n--\n\n"
    "Write a message's joints as they are and with standard bones, the egocentric frame, and both in it,\n"
    "(45 + 45 + 16 + 45 + 45). False where a joint is unknown or, as a bone, not usable.");
static PyObject *body(PyObject *module, PyObject *args)
{
    PyObject *message;
    Py_buffer b[5];
    double reach_m, bone_m, shortest_m, ego[16];
    if (!PyArg_ParseTuple(args, "Oy*y*y*y*dddw*", &message, &b[0], &b[1], &b[2], &b[3], &reach_m, &bone_m, &shortest_m,
                          &b[4]))
        return NULL;
    const double *lengths_m = b[2].buf;
    const int32_t *parents = b[0].buf, *children = b[1].buf, *hips_torso = b[3].buf, torso = hips_torso[2];
    double *joints = b[4].buf, *scaled = joints + COORDINATES, *frame = scaled + COORDINATES;
    double *measured_ego = frame + 16, *scaled_ego = measured_ego + COORDINATES, from_torso[COORDINATES] = {0};
    int usable = read_joints(message, joints) == 0;
    for (int i = 0; i < COORDINATES; i++)
        usable &= fabs(joints[i]) <= reach_m;
    for (int bone = 0; bone < JOINTS - 1; bone++) {
        double vector[3], length;
        for (int i = 0; i < 3; i++)
            vector[i] = joints[3 * children[bone] + i] - joints[3 * parents[bone] + i];
        length = length3(vector);
        usable &= length >= shortest_m && length * length <= bone_m * bone_m;
        for (int i = 0; i < 3; i++)
            from_torso[3 * children[bone] + i] = from_torso[3 * parents[bone] + i] + vector[i] * (lengths_m[bone] / length);
    }
    for (int i = 0; i < COORDINATES; i++)
        scaled[i] = joints[3 * torso + i % 3] + from_torso[i];
    usable = usable && ego_from_camera(joints, hips_torso, shortest_m, frame)
        && ego_from_camera(scaled, hips_torso, shortest_m, ego);
    if (usable) {
        apply(frame, joints, measured_ego);
        apply(ego, scaled, scaled_ego);
    }
    for (int n = 0; n < 5; n++)
        PyBuffer_Release(&b[n]);
    return PyErr_Occurred() ? NULL : PyBool_FromLong(usable);
}

/* Turn points by a rotation (3, 3) as BLAS multiplies: each product after the first is added without rounding it. */
static void turned(const double *rotation, const double *points, double *out)
{
    for (int joint = 0; joint < JOINTS; joint++, points += 3)
        for (int row = 0; row < 3; row++)
            *out++ = fma(points[2], rotation[3 * row + 2], fma(points[1], rotation[3 * row + 1],
                                                                points[0] * rotation[3 * row]));
}

/* The mean direction (x, z) from right to left hip and shoulder, of those that are long enough, as
   heading.horizontal_left. */
static void horizontal_left(const double *joints, const int32_t *pairs, double shortest, double *left)
{
    double sum[3] = {0};
    int known = 0;
    for (int pair = 0; pair < 2; pair++) {
        double across[3], unit[3];
        for (int i = 0; i < 3; i++)
            across[i] = joints[3 * pairs[2 + pair] + i] - joints[3 * pairs[pair] + i];
        if (!unit3(across, shortest, unit))
            continue;
        known++;
        for (int i = 0; i < 3; i++)
            sum[i] += unit[i];
    }
    left[0] = known == 2 ? sum[0] / 2 : sum[0];
    left[1] = known == 2 ? sum[2] / 2 : sum[2];
}

enum { SPAN, MEAN_X, MEAN_Z, VARIANCE, LEFT_X, LEFT_Z };
enum { FIRST_S, TURNING_S, SHORTEST_MEAN, INFLATION, FACING_VARIANCE, FULL_TURN };

/* Advance the state of a HeadingFilter, (6,), by the direction to the left, as HeadingFilter does. */
static void advance_heading(double *state, const double *left, double elapsed_s, const double *tuned)
{
    if (elapsed_s <= 0) {
        state[SPAN] = tuned[FIRST_S];
        state[MEAN_X] = left[0];
        state[MEAN_Z] = left[1];
        state[VARIANCE] = 0.0;
    } else {
        state[SPAN] += elapsed_s;
        double gain = 1.0 - exp(-elapsed_s / tuned[TURNING_S]), share = elapsed_s / state[SPAN];
        double weight = share > gain ? share : gain;
        state[MEAN_X] += weight * (left[0] - state[MEAN_X]);
        state[MEAN_Z] += weight * (left[1] - state[MEAN_Z]);
        if (hypot(left[0], left[1]) >= tuned[SHORTEST_MEAN]) {
            double error_rad
                = remainder(atan2(left[1], left[0]) - atan2(state[MEAN_Z], state[MEAN_X]), tuned[FULL_TURN]);
            state[VARIANCE] += gain * (error_rad * error_rad - state[VARIANCE]);
        }
    }
    if (hypot(state[MEAN_X], state[MEAN_Z]) >= tuned[SHORTEST_MEAN]) {
        double seen_rad = atan2(state[MEAN_Z], state[MEAN_X]), facing = cos(seen_rad);
        double variance = tuned[INFLATION] * state[VARIANCE];
        double yaw_rad
            = seen_rad * (1.0 - (facing > 0.0 ? facing : 0.0) * variance / (variance + tuned[FACING_VARIANCE]));
        state[LEFT_X] = cos(yaw_rad);
        state[LEFT_Z] = sin(yaw_rad);
    }
}

/* Advance the low-passed joints relative to the torso, and write each part's mean displacement, as PartMotionFilter. */
static void advance_motion(double *smooth, const double *joints, int torso, double gain, const int32_t *part_of, double *motion)
{
    int known[PARTS] = {0};
    memset(motion, 0, PARTS * sizeof *motion);
    for (int joint = 0; joint < JOINTS; joint++) {
        double step[3], length;
        for (int i = 0; i < 3; i++) {
            double relative = joints[3 * joint + i] - joints[3 * torso + i];
            step[i] = gain * (relative - smooth[3 * joint + i]);
            smooth[3 * joint + i] = isnan(step[i]) ? relative : smooth[3 * joint + i] + step[i];
        }
        length = length3(step);
        if (!isnan(length)) {
            motion[part_of[joint]] += length;
            known[part_of[joint]]++;
        }
    }
    for (int part = 0; part < PARTS; part++)
        motion[part] /= known[part] ? known[part] : 1;
}

PyDoc_STRVAR(posture_doc,
    "posture(body, level, heading, elapsed_s, pairs, tuned, shortest_m, smooth, gain, torso, part_of)\n"
    "--\n\n"
    "Advance a person's filters by what `body` wrote, and return the lists of a posture: the joints in the egocentric\n"
    "frame, measured and with standard bones, upright ones, that frame, and the motion of each part.");
static PyObject *posture(PyObject *module, PyObject *args)
{
    Py_buffer b[7];
    double elapsed_s, shortest_m, gain;
    int torso;
    if (!PyArg_ParseTuple(args, "y*z*w*dy*y*dw*diy*", &b[0], &b[1], &b[2], &elapsed_s, &b[3], &b[4], &shortest_m, &b[5],
                          &gain, &torso, &b[6]))
        return NULL;
    const double *joints = b[0].buf, *scaled = joints + COORDINATES, *frame = scaled + COORDINATES;
    const double *level = b[1].buf, *metric = joints;
    double turned_metric[COORDINATES], turned_scaled[COORDINATES], upright[COORDINATES], left[2], motion[PARTS] = {0};
    double *heading = b[2].buf, *smooth = b[5].buf;
    if (level != NULL) {
        turned(level, joints, turned_metric);
        turned(level, scaled, turned_scaled);
        metric = turned_metric;
        scaled = turned_scaled;
    }
    horizontal_left(metric, b[3].buf, shortest_m, left);
    advance_heading(heading, left, elapsed_s, b[4].buf);
    for (int i = 0; i < COORDINATES; i++)
        upright[i] = scaled[i] - scaled[3 * torso + i % 3];
    const double axes[9] = {heading[LEFT_X], 0, heading[LEFT_Z], 0, -1, 0, heading[LEFT_Z], 0, -heading[LEFT_X]};
    memcpy(turned_scaled, upright, sizeof upright);
    turned(axes, turned_scaled, upright);
    if (gain > 0)
        advance_motion(smooth, joints, torso, gain, b[6].buf, motion);
    else
        for (int i = 0; i < COORDINATES; i++)
            smooth[i] = joints[i] - joints[3 * torso + i % 3];
    PyObject *lists[5] = {listed_joints(frame + 16), listed_joints(frame + 16 + COORDINATES), listed_joints(upright),
                          listed(frame, 16), listed(motion, PARTS)};
    for (int n = 0; n < 7; n++)
        PyBuffer_Release(&b[n]);
    return Py_BuildValue("NNNNN", lists[0], lists[1], lists[2], lists[3], lists[4]);
}

PyDoc_STRVAR(spreads_doc,
    "spreads(before, after)\n--\n\n"
    "Return each limb's spread (mm) over the frames between two sums of moments, a list.");
static PyObject *spreads(PyObject *module, PyObject *args)
{
    Py_buffer b[2];
    double of[LIMBS];
    if (!PyArg_ParseTuple(args, "y*y*", &b[0], &b[1]))
        return NULL;
    const int64_t *before = b[0].buf, *after = b[1].buf;
    for (int limb = 0; limb < LIMBS; limb++, before += MOMENTS, after += MOMENTS) {
        int64_t count = after[MOMENTS - 1] - before[MOMENTS - 1], squares = after[MOMENTS - 2] - before[MOMENTS - 2];
        double means2 = 0.0, variance;
        for (int i = 0; i < MOMENTS - 2; i++) {
            double sum = (double)(after[i] - before[i]);
            means2 += sum * sum;
        }
        variance = count ? (double)squares / (double)count - means2 / ((double)count * (double)count) : 0.0;
        of[limb] = variance > 0.0 ? sqrt(variance) : 0.0;
    }
    PyBuffer_Release(&b[0]);
    PyBuffer_Release(&b[1]);
    return Py_BuildValue("[dddd]", of[0], of[1], of[2], of[3]);
}

VECTORISED static void add_row(const float *activity, float scale, const uint32_t *before, uint32_t *after, Py_ssize_t n)
{
    for (Py_ssize_t u = 0; u < n; u++)
        after[u] = before[u] + (uint32_t)(int32_t)rintf(activity[u] * scale);
}

PyDoc_STRVAR(running_sums_doc,
    "running_sums(activities, scale, sums)\n--\n\n"
    "Write the sums of quantised activities (n, units) before each row and after the last, (n + 1, units).");
static PyObject *running_sums(PyObject *module, PyObject *args)
{
    Py_buffer b[2];
    float scale;
    Py_ssize_t units;
    if (!PyArg_ParseTuple(args, "y*fnw*", &b[0], &scale, &units, &b[1]))
        return NULL;
    const float *activities = b[0].buf;
    uint32_t *sums = b[1].buf;
    if (b[1].len != b[0].len + units * (Py_ssize_t)sizeof *sums) {
        PyErr_SetString(PyExc_ValueError, "there are not as many rows of sums as rows of activities and one");
        return released(b, 2);
    }
    memset(sums, 0, units * sizeof *sums);
    for (Py_ssize_t row = 0; row < b[0].len / (Py_ssize_t)sizeof(float) / units; row++)
        add_row(activities + row * units, scale, sums + row * units, sums + (row + 1) * units, units);
    return released(b, 2);
}

typedef struct {
    int64_t lag_ns, memory_ns, decided_ns;
    double overlap;
    const int64_t *starts_ns, *ends_ns;
    const double *gains;
    Py_ssize_t *pending, waiting, *step, *before; /* step, before: the best set's last member up to each, and before it */
    double *best;
} Decoding;

/* Find the best set of those that wait, as best_set does; write its members in order to `chosen`. */
static Py_ssize_t best_set(Decoding *d, Py_ssize_t *chosen)
{
    Py_ssize_t count = 0;
    d->best[0] = 0.0;
    d->step[0] = 0;
    for (Py_ssize_t n = 1; n <= d->waiting; n++) {
        Py_ssize_t candidate = d->pending[n - 1], low = 0, high = n;
        while (low < high) { /* the first of those before it that ends at its start or later; the 0th ended at -1 */
            Py_ssize_t middle = (low + high) / 2;
            int64_t end_ns = middle ? d->ends_ns[d->pending[middle - 1]] : -1;
            if (end_ns < d->starts_ns[candidate])
                low = middle + 1;
            else
                high = middle;
        }
        d->before[n] = low > 0 ? low - 1 : 0;
        double gain = d->best[d->before[n]] + d->gains[candidate];
        d->step[n] = gain > d->best[n - 1];
        d->best[n] = d->step[n] ? gain : d->best[n - 1];
    }
    for (Py_ssize_t n = d->waiting; n > 0; n = d->step[n] ? d->before[n] : n - 1)
        count += d->step[n];
    for (Py_ssize_t n = d->waiting, k = count; n > 0; n = d->step[n] ? d->before[n] : n - 1)
        if (d->step[n])
            chosen[--k] = d->pending[n - 1];
    return count;
}

/* Take the candidates that end now, up to `after`, and append to `found` what is decided; -1 where an error is set. */
static int decode_step(Decoding *d, int64_t now_ns, Py_ssize_t *next, Py_ssize_t after, Py_ssize_t *chosen, PyObject *found)
{
    Py_ssize_t kept = 0, count;
    int64_t decided_ns = d->decided_ns;
    while (*next < after && d->ends_ns[*next] == now_ns)
        d->pending[d->waiting++] = (*next)++;
    for (Py_ssize_t n = 0; n < d->waiting; n++) {
        int64_t start_ns = d->starts_ns[d->pending[n]], end_ns = d->ends_ns[d->pending[n]];
        if (end_ns >= now_ns - d->memory_ns && end_ns > decided_ns
            && (double)(decided_ns - start_ns) <= d->overlap * (double)(end_ns - start_ns))
            d->pending[kept++] = d->pending[n];
    }
    d->waiting = kept;
    count = best_set(d, chosen);
    for (Py_ssize_t k = 0; k < count && d->ends_ns[chosen[k]] <= now_ns - d->lag_ns; k++) {
        int64_t start_ns = d->starts_ns[chosen[k]];
        PyObject *one = Py_BuildValue("nLL", chosen[k], (long long)(start_ns > decided_ns ? start_ns : decided_ns + 1),
                                      (long long)now_ns);
        int failed = one == NULL || PyList_Append(found, one) < 0;
        Py_XDECREF(one);
        if (failed)
            return -1;
        d->decided_ns = d->ends_ns[chosen[k]];
    }
    return 0;
}

PyDoc_STRVAR(decoded_doc,
    "decoded(starts_ns, ends_ns, gains, decisions_ns, restarts, lag_ns, memory_ns, overlap) -> list\n--\n\n"
    "Decide on candidates, in the order of their ends, as a Decoder does at each of the decisions' instants, of which\n"
    "some restart it: the number of each segment's candidate, its start and the instant of the decision (ns).");
static PyObject *decoded(PyObject *module, PyObject *args)
{
    Py_buffer b[5];
    long long lag_ns, memory_ns;
    double overlap;
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*LLd", &b[0], &b[1], &b[2], &b[3], &b[4], &lag_ns, &memory_ns, &overlap))
        return NULL;
    Py_ssize_t count = b[0].len / 8, decisions = b[3].len / 8, next = 0;
    const int64_t *decisions_ns = b[3].buf;
    const uint8_t *restarts = b[4].buf;
    Py_ssize_t *room = PyMem_Malloc((4 * count + 4) * sizeof *room);
    double *best = PyMem_Malloc((count + 1) * sizeof *best);
    PyObject *found = PyList_New(0);
    if (room == NULL || best == NULL)
        PyErr_NoMemory();
    Decoding d = {lag_ns, memory_ns, -1, overlap, b[0].buf, b[1].buf, b[2].buf, room, 0, room + count + 1,
                  room + 2 * count + 2, best};
    for (Py_ssize_t k = 0; k < decisions && !PyErr_Occurred(); k++) {
        if (restarts[k])
            d.waiting = 0;
        if ((d.waiting || (next < count && d.ends_ns[next] == decisions_ns[k]))
            && decode_step(&d, decisions_ns[k], &next, count, room + 3 * count + 3, found) < 0)
            break;
    }
    PyMem_Free(room);
    PyMem_Free(best);
    for (int n = 0; n < 5; n++)
        PyBuffer_Release(&b[n]);
    if (PyErr_Occurred())
        Py_CLEAR(found);
    return found;
}

/* The responses of one kernel of -1 and 2 to an input that is 0 beyond its ends. */
VECTORISED static void respond(const float *input, const int8_t *kernel, int weights, int dilation, int instants, float *out)
{
    float padded[3 * MOST_INSTANTS] = {0};
    memcpy(padded + MOST_INSTANTS, input, instants * sizeof *input);
    for (int w = 0; w < weights; w++) {
        const float *from = padded + MOST_INSTANTS + (w - weights / 2) * dilation;
        float weight = kernel[w];
        for (int at = 0; at < instants; at++)
            out[at] = (w ? out[at] : 0.0f) + from[at] * weight;
    }
}

VECTORISED static int count_above(const float *response, float bias, const int32_t *counted, int instants)
{
    int count = 0;
    for (int at = 0; at < instants; at++)
        count += counted[at] & -(response[at] > bias);
    return count;
}

PyDoc_STRVAR(exceeding_doc,
    "exceeding(inputs, kernels, dilations, weights, biases, counted, counts, out)\n--\n\n"
    "Write for each filter and each of its biases the share of the instants that count at which the response exceeds it.");
static PyObject *exceeding(PyObject *module, PyObject *args)
{
    Py_buffer b[7];
    int weights;
    if (!PyArg_ParseTuple(args, "y*y*y*iy*y*y*w*", &b[0], &b[1], &b[2], &weights, &b[3], &b[4], &b[5], &b[6]))
        return NULL;
    const int8_t *kernels = b[1].buf;
    const int32_t *dilations = b[2].buf;
    const int32_t *counted = b[4].buf;
    const float *inputs = b[0].buf, *biases = b[3].buf, *counts = b[5].buf;
    float *out = b[6].buf, response[MOST_INSTANTS];
    Py_ssize_t filters = b[5].len / (Py_ssize_t)sizeof(float), of_each = b[6].len / (Py_ssize_t)sizeof(float) / filters;
    Py_ssize_t kernel_count = b[1].len / weights;
    int instants = (int)(b[4].len / 4 / filters);
    if (instants > MOST_INSTANTS)
        PyErr_SetString(PyExc_ValueError, "more instants than the compiled step has room for");
    for (Py_ssize_t f = 0; f < filters && !PyErr_Occurred(); f++) {
        respond(inputs + f * instants, kernels + f % kernel_count * weights, weights, dilations[f / kernel_count], instants,
                response);
        for (Py_ssize_t n = 0; n < of_each; n++)
            out[f * of_each + n]
                = (float)count_above(response, biases[f * of_each + n], counted + f * instants, instants) / counts[f];
    }
    return released(b, 7);
}

static PyMethodDef methods[] = {
    {"accumulated", accumulated, METH_VARARGS, accumulated_doc},
    {"body", body, METH_VARARGS, body_doc},
    {"decoded", decoded, METH_VARARGS, decoded_doc},
    {"exceeding", exceeding, METH_VARARGS, exceeding_doc},
    {"exponents", exponents, METH_VARARGS, exponents_doc},
    {"map_inputs", map_inputs, METH_VARARGS, map_inputs_doc},
    {"pooled", pooled, METH_VARARGS, pooled_doc},
    {"posture", posture, METH_VARARGS, posture_doc},
    {"running_sums", running_sums, METH_VARARGS, running_sums_doc},
    {"smoothed", smoothed, METH_VARARGS, smoothed_doc},
    {"spreads", spreads, METH_VARARGS, spreads_doc},
    {"totals", totals, METH_VARARGS, totals_doc},
    {NULL, NULL, 0, NULL},
};
static struct PyModuleDef definition = {PyModuleDef_HEAD_INIT, "actum._compiled", NULL, 0, methods, NULL, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit__compiled(void) { return PyModuleDef_Init(&definition); }
