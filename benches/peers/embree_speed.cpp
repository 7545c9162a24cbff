// Times a neutral scene (.nsc, from generate.py) with Embree 3, ray by ray or in packets of sixteen: the mark that our own tracing
// is held against.
//
// usage: embree_speed IN.nsc PACKET THREADS FRAMES [OUT.ppm]        PACKET is 1 or 16
// prints {"build": seconds, "frames": [seconds of tracing, ...], "rays": {"camera": n, "shadow": n, "reflection": n}}
// needs: Embree 3 (Debian: libembree-dev); g++ -O3 -march=native -ffast-math -std=c++17 embree_speed.cpp -o embree_speed -lembree3 -lpthread
//
// All in single precision, and without a thought for hard cases: points are moved off surfaces along the normal, by 1e-5 of the
// eye's distance from the origin. Boxes are a geometry of our own, met by their slabs, which is faster than quads are. Each packet
// is shaded before the next one is made; what is mirrored goes on in its packet.

#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <thread>

#include "neutral_scene.hpp"

namespace {

constexpr float INFINITE = std::numeric_limits<float>::infinity();
constexpr unsigned SPHERES = 0, BOXES = 1, PLANES = 2, NONE = RTC_INVALID_GEOMETRY_ID;

struct Point { float x, y, z; };
Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Point operator*(Point a, float s) { return {a.x * s, a.y * s, a.z * s}; }
float dot(Point a, Point b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Point normalized(Point a) { return a * (1 / std::sqrt(dot(a, a))); }
Point single(Vector a) { return {float(a.x), float(a.y), float(a.z)}; }

struct Slabs { float low[3], high[3]; };
struct Sender { Point place, color; };
struct Surface { Point color; float ambient, diffuse, reflection; };
struct Floor { Point normal; float offset; int material; };

// The scene in single precision.
struct World {
    int width, height, depth;
    Point background, eye, corner, right, up;
    float step;
    std::vector<Sender> lights;
    std::vector<Surface> surfaces;
    std::vector<Floor> floors;
    std::vector<Sphere> spheres;
    std::vector<Slabs> boxes;
    std::vector<int> sphere_materials, box_materials;
    RTCScene tree;
};

World world;

World prepared(const Scene &scene) {
    World made{};
    made.width = scene.width, made.height = scene.height, made.depth = scene.depth;
    made.background = single(scene.background), made.eye = single(scene.camera.eye);
    const Camera &camera = scene.camera;
    const Vector right = normalized(cross(camera.up, camera.view));
    const double pitch = 1 / camera.zoom / scene.height;
    made.corner = single(camera.view - right * (pitch * scene.width / 2) + camera.up * (pitch * scene.height / 2));
    made.right = single(right * pitch), made.up = single(camera.up * pitch);
    made.step = 1e-5f * std::sqrt(dot(made.eye, made.eye));
    for (const Light &light : scene.lights) made.lights.push_back({single(light.place), single(light.color)});
    for (const Material &m : scene.materials)
        made.surfaces.push_back({single(m.color), float(m.ambient), float(m.diffuse), float(m.reflection)});
    for (const Plane &plane : scene.planes) made.floors.push_back({single(plane.normal), float(plane.offset), plane.material});
    made.spheres = scene.spheres, made.sphere_materials = scene.sphere_materials;
    for (const Box &box : scene.boxes) {
        const Point low = single(box.low), high = single(box.high);
        made.boxes.push_back({{low.x, low.y, low.z}, {high.x, high.y, high.z}});
    }
    made.box_materials = scene.box_materials;
    return made;
}

void bound_box(const RTCBoundsFunctionArguments *query) {
    const Slabs &box = world.boxes[query->primID];
    RTCBounds &bounds = *query->bounds_o;
    bounds.lower_x = box.low[0], bounds.lower_y = box.low[1], bounds.lower_z = box.low[2];
    bounds.upper_x = box.high[0], bounds.upper_y = box.high[1], bounds.upper_z = box.high[2];
}

// Meets a box with the rays of a packet; `hit` is null where only occlusion is asked for.
void meet_box(const int *valid, unsigned count, unsigned geometry, unsigned primitive, RTCRayN *ray, RTCHitN *hit) {
    const Slabs &box = world.boxes[primitive];
    for (unsigned i = 0; i < count; i++) {
        if (!valid[i]) continue;
        const float origin[3] = {RTCRayN_org_x(ray, count, i), RTCRayN_org_y(ray, count, i), RTCRayN_org_z(ray, count, i)};
        const float speed[3] = {RTCRayN_dir_x(ray, count, i), RTCRayN_dir_y(ray, count, i), RTCRayN_dir_z(ray, count, i)};
        float entry = -INFINITE, exit = INFINITE;
        int face = 0;
        for (int axis = 0; axis < 3; axis++) {
            const float inverse = 1 / speed[axis];
            const float at_low = (box.low[axis] - origin[axis]) * inverse, at_high = (box.high[axis] - origin[axis]) * inverse;
            const float near = std::min(at_low, at_high), far = std::max(at_low, at_high);
            if (near > entry) entry = near, face = axis;
            exit = std::min(exit, far);
        }
        float &limit = RTCRayN_tfar(ray, count, i);
        const float nearest = RTCRayN_tnear(ray, count, i), t = entry >= nearest ? entry : exit;
        if (entry > exit || exit < nearest || t > limit) continue;
        if (!hit) {
            limit = -INFINITE;
            continue;
        }
        limit = t;
        float normal[3] = {0, 0, 0};
        normal[face] = speed[face] > 0 ? -1.0f : 1.0f;
        RTCHitN_Ng_x(hit, count, i) = normal[0], RTCHitN_Ng_y(hit, count, i) = normal[1], RTCHitN_Ng_z(hit, count, i) = normal[2];
        RTCHitN_primID(hit, count, i) = primitive, RTCHitN_geomID(hit, count, i) = geometry;
        RTCHitN_instID(hit, count, i, 0) = RTC_INVALID_GEOMETRY_ID;
    }
}

void intersect_box(const RTCIntersectFunctionNArguments *query) {
    RTCRayHitN *both = query->rayhit;
    meet_box(query->valid, query->N, query->geomID, query->primID, RTCRayHitN_RayN(both, query->N), RTCRayHitN_HitN(both, query->N));
}

void occlude_box(const RTCOccludedFunctionNArguments *query) {
    meet_box(query->valid, query->N, query->geomID, query->primID, query->ray, nullptr);
}

RTCScene build(RTCDevice device) {
    const RTCScene tree = rtcNewScene(device);
    const auto attach = [&](RTCGeometry geometry, unsigned kind) {
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(tree, geometry, kind);
        rtcReleaseGeometry(geometry);
    };
    if (!world.spheres.empty()) {
        const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, world.spheres.data(), 0, sizeof(Sphere),
                                   world.spheres.size());
        attach(geometry, SPHERES);
    }
    if (!world.boxes.empty()) {
        const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, world.boxes.size());
        rtcSetGeometryBoundsFunction(geometry, bound_box, nullptr);
        rtcSetGeometryIntersectFunction(geometry, intersect_box);
        rtcSetGeometryOccludedFunction(geometry, occlude_box);
        attach(geometry, BOXES);
    }
    rtcCommitScene(tree);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) fail("Embree cannot build the scene");
    return tree;
}

// Rays of a packet, and how Embree is asked about them. A number of a packet of one is no array: both are read by address.
template <int N> struct Packet;

template <> struct Packet<1> {
    using Rays = RTCRay;
    using Hits = RTCRayHit;
    static constexpr int columns = 1, rows = 1;
    static void intersect(const int *, RTCIntersectContext *context, Hits *hits) { rtcIntersect1(world.tree, context, hits); }
    static void occlude(const int *, RTCIntersectContext *context, Rays *rays) { rtcOccluded1(world.tree, context, rays); }
};

template <> struct Packet<16> {
    using Rays = RTCRay16;
    using Hits = RTCRayHit16;
    static constexpr int columns = 4, rows = 4;
    static void intersect(const int *asked, RTCIntersectContext *context, Hits *hits) {
        rtcIntersect16(asked, world.tree, context, hits);
    }
    static void occlude(const int *asked, RTCIntersectContext *context, Rays *rays) {
        rtcOccluded16(asked, world.tree, context, rays);
    }
};

template <class T> auto &lane(T &numbers, int i) { return reinterpret_cast<std::remove_all_extents_t<T> *>(&numbers)[i]; }

template <class Rays> Point origin(Rays &rays, int i) { return {lane(rays.org_x, i), lane(rays.org_y, i), lane(rays.org_z, i)}; }
template <class Rays> Point direction(Rays &rays, int i) { return {lane(rays.dir_x, i), lane(rays.dir_y, i), lane(rays.dir_z, i)}; }

template <class Rays> void set(Rays &rays, int i, Point from, Point towards, float limit) {
    lane(rays.org_x, i) = from.x, lane(rays.org_y, i) = from.y, lane(rays.org_z, i) = from.z;
    lane(rays.dir_x, i) = towards.x, lane(rays.dir_y, i) = towards.y, lane(rays.dir_z, i) = towards.z;
    lane(rays.tnear, i) = 0, lane(rays.tfar, i) = limit, lane(rays.time, i) = 0;
    lane(rays.mask, i) = ~0u, lane(rays.flags, i) = 0;
}

template <class Rays> float distance_to(const Floor &floor, Rays &rays, int i) {
    return (floor.offset - dot(floor.normal, origin(rays, i))) / dot(floor.normal, direction(rays, i));
}

struct alignas(64) Counts { unsigned long camera = 0, shadow = 0, reflection = 0; };

// What a packet's rays have met.
template <int N> struct alignas(64) Met {
    float x[N], y[N], z[N], normal_x[N], normal_y[N], normal_z[N];
    // -1 where it is nothing.
    int material[N];
};

template <int N> void closest(typename Packet<N>::Hits &hits, const int *asked, bool coherent, Met<N> &met) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    Packet<N>::intersect(asked, &context, &hits);
    auto &rays = hits.ray;
    for (unsigned k = 0; k < world.floors.size(); k++)
        for (int i = 0; i < N; i++) {
            const float t = distance_to(world.floors[k], rays, i);
            const bool nearer = t > lane(rays.tnear, i) && t < lane(rays.tfar, i);
            lane(rays.tfar, i) = nearer ? t : lane(rays.tfar, i);
            lane(hits.hit.geomID, i) = nearer ? PLANES + k : lane(hits.hit.geomID, i);
        }
    for (int i = 0; i < N; i++) {
        const unsigned kind = lane(hits.hit.geomID, i), index = lane(hits.hit.primID, i);
        met.material[i] = -1;
        if (kind == NONE) continue;
        const Point towards = direction(rays, i), point = origin(rays, i) + towards * lane(rays.tfar, i);
        Point normal;
        if (kind == SPHERES) {
            const Sphere &sphere = world.spheres[index];
            normal = normalized(point - Point{sphere.x, sphere.y, sphere.z}), met.material[i] = world.sphere_materials[index];
        } else if (kind == BOXES) {
            normal = {lane(hits.hit.Ng_x, i), lane(hits.hit.Ng_y, i), lane(hits.hit.Ng_z, i)};
            met.material[i] = world.box_materials[index];
        } else {
            normal = world.floors[kind - PLANES].normal, met.material[i] = world.floors[kind - PLANES].material;
        }
        if (dot(normal, towards) > 0) normal = normal * -1;
        const Point off = point + normal * world.step;
        met.x[i] = off.x, met.y[i] = off.y, met.z[i] = off.z;
        met.normal_x[i] = normal.x, met.normal_y[i] = normal.y, met.normal_z[i] = normal.z;
    }
}

// Adds to each lane's sum what a light brings there.
template <int N> void add_light(const Sender &light, const Met<N> &met, const int *asked, float (&sum)[3][N], Counts &counts) {
    alignas(64) typename Packet<N>::Rays rays;
    alignas(64) int facing[N];
    alignas(64) float cosines[N];
    int count = 0;
    for (int i = 0; i < N; i++) {
        const Point point{met.x[i], met.y[i], met.z[i]}, way = light.place - point;
        const float distance = std::sqrt(dot(way, way));
        const Point towards = way * (1 / distance);
        cosines[i] = met.normal_x[i] * towards.x + met.normal_y[i] * towards.y + met.normal_z[i] * towards.z;
        const bool asks = asked[i] && met.material[i] >= 0 && cosines[i] > 0;
        facing[i] = asks ? -1 : 0, count += asks;
        set(rays, i, point, towards, distance);
    }
    if (count == 0) return;
    counts.shadow += count;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    Packet<N>::occlude(facing, &context, &rays);
    for (const Floor &floor : world.floors)
        for (int i = 0; i < N; i++) {
            const float t = distance_to(floor, rays, i);
            lane(rays.tfar, i) = t > 0 && t < lane(rays.tfar, i) ? -INFINITE : lane(rays.tfar, i);
        }
    for (int i = 0; i < N; i++) {
        const float share = facing[i] && lane(rays.tfar, i) >= 0 ? cosines[i] : 0;
        sum[0][i] += light.color.x * share, sum[1][i] += light.color.y * share, sum[2][i] += light.color.z * share;
    }
}

void add(float *color, float weight, Point light) {
    color[0] += weight * light.x, color[1] += weight * light.y, color[2] += weight * light.z;
}

// Traces the pixels of a packet, the first in this column and row.
template <int N> void trace(int column, int row, std::vector<unsigned char> &image, Counts &counts) {
    alignas(64) typename Packet<N>::Hits hits;
    Met<N> met{};
    alignas(64) int asked[N];
    alignas(64) float weights[N], colors[N][3] = {}, sum[3][N];
    for (int i = 0; i < N; i++) {
        const float x = column + i % Packet<N>::columns + 0.5f, y = row + i / Packet<N>::columns + 0.5f;
        set(hits.ray, i, world.eye, normalized(world.corner + world.right * x - world.up * y), INFINITE);
        asked[i] = -1, weights[i] = 1;
    }
    for (int generation = 1, going = N; going > 0; generation++) {
        (generation == 1 ? counts.camera : counts.reflection) += going;
        for (int i = 0; i < N; i++) lane(hits.hit.geomID, i) = NONE, lane(hits.hit.instID, i) = RTC_INVALID_GEOMETRY_ID;
        closest<N>(hits, asked, generation == 1, met);
        std::fill(&sum[0][0], &sum[0][0] + 3 * N, 0.0f);
        for (const Sender &light : world.lights) add_light<N>(light, met, asked, sum, counts);
        going = 0;
        for (int i = 0; i < N; i++) {
            if (!asked[i]) continue;
            asked[i] = 0;
            if (met.material[i] < 0) {
                add(colors[i], weights[i], world.background);
                continue;
            }
            const Surface &surface = world.surfaces[met.material[i]];
            const Point lit{surface.ambient + surface.diffuse * sum[0][i], surface.ambient + surface.diffuse * sum[1][i],
                            surface.ambient + surface.diffuse * sum[2][i]};
            add(colors[i], weights[i], {surface.color.x * lit.x, surface.color.y * lit.y, surface.color.z * lit.z});
            if (surface.reflection <= 0) continue;
            weights[i] *= surface.reflection;
            if (generation == world.depth) {
                add(colors[i], weights[i], world.background);
                continue;
            }
            const Point towards = direction(hits.ray, i), normal{met.normal_x[i], met.normal_y[i], met.normal_z[i]};
            set(hits.ray, i, {met.x[i], met.y[i], met.z[i]}, towards - normal * (2 * dot(towards, normal)), INFINITE);
            asked[i] = -1, going++;
        }
    }
    for (int i = 0; i < N; i++) {
        const size_t pixel = size_t(row + i / Packet<N>::columns) * world.width + column + i % Packet<N>::columns;
        for (int k = 0; k < 3; k++) image[3 * pixel + k] = static_cast<unsigned char>(std::min(colors[i][k] * 255 + 0.5f, 255.0f));
    }
}

// Renders a frame in tiles over threads; returns the rays traced.
template <int N> Counts render(std::vector<unsigned char> &image, unsigned threads) {
    constexpr int side = 32;
    const int across = (world.width + side - 1) / side, down = (world.height + side - 1) / side;
    std::vector<Counts> counts(threads);
    std::atomic<int> next{0};
    const auto work = [&](unsigned thread) {
        _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
        _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
        for (int tile; (tile = next++) < across * down;) {
            const int left = tile % across * side, top = tile / across * side;
            for (int row = top; row < std::min(top + side, world.height); row += Packet<N>::rows)
                for (int column = left; column < std::min(left + side, world.width); column += Packet<N>::columns)
                    trace<N>(column, row, image, counts[thread]);
        }
    };
    std::vector<std::thread> others;
    for (unsigned thread = 1; thread < threads; thread++) others.emplace_back(work, thread);
    work(0);
    for (std::thread &other : others) other.join();
    Counts all;
    for (const Counts &part : counts) all.camera += part.camera, all.shadow += part.shadow, all.reflection += part.reflection;
    return all;
}

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

} // namespace

int main(int count, char **arguments) {
    const int packet = count > 2 ? std::atoi(arguments[2]) : 0, threads = count > 3 ? std::atoi(arguments[3]) : 0;
    const int frames = count > 4 ? std::atoi(arguments[4]) : 0;
    if (count < 5 || count > 6 || (packet != 1 && packet != 16) || threads < 1 || frames < 1)
        fail("usage: embree_speed IN.nsc PACKET THREADS FRAMES [OUT.ppm]        PACKET is 1 or 16");
    world = prepared(read_scene(arguments[1]));
    if (world.width % 4 || world.height % 4) fail("width and height must be multiples of four");
    const RTCDevice device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    if (!device) fail("Embree does not start");
    const double start = seconds();
    world.tree = build(device);
    std::printf("{\"build\": %.6f, \"frames\": [", seconds() - start);
    std::vector<unsigned char> image(size_t(world.width) * world.height * 3);
    Counts counts;
    for (int frame = 0; frame < frames; frame++) {
        const double begun = seconds();
        counts = packet == 1 ? render<1>(image, threads) : render<16>(image, threads);
        std::printf("%s%.6f", frame ? ", " : "", seconds() - begun);
    }
    std::printf("], \"rays\": {\"camera\": %lu, \"shadow\": %lu, \"reflection\": %lu}}\n", counts.camera, counts.shadow, counts.reflection);
    if (count == 6) {
        std::ofstream out(arguments[5], std::ios::binary);
        out << "P6\n" << world.width << ' ' << world.height << "\n255\n";
        out.write(reinterpret_cast<const char *>(image.data()), std::streamsize(image.size()));
        out.close();
        if (!out) fail(std::string("cannot write ") + arguments[5]);
    }
    rtcReleaseScene(world.tree);
    rtcReleaseDevice(device);
}
