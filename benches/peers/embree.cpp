// Renders a neutral scene (.nsc, from generate.py) with Embree 3, for its picture and its counts of rays; not for its time.
//
// usage: embree IN.nsc OUT.ppm        prints the rays traced, as {"camera": n, "shadow": n, "reflection": n}
// needs: Embree 3 (Debian: libembree-dev); g++ -O2 -std=c++17 embree.cpp -o embree -lembree3
//
// Which sphere or box a ray meets, at which distance, and what stands before a light, is for Embree to say, in single
// precision. It has no planes: they are met here. The rest is the model that the scenes are made for, in double precision.
//
// A shape never stops a ray that leaves it: all of them are convex, and seen from outside. So no offset has to be chosen.
// A shadow ray is traced where it can matter: from a surface with something diffuse, to a light in front of it. The depth
// is the number of generations of rays, camera rays being the first; what would be mirrored beyond is the background.

#include <embree3/rtcore.h>

#include <algorithm>
#include <limits>

#include "neutral_scene.hpp"

namespace {

constexpr double INFINITE = std::numeric_limits<double>::infinity();

// What a shape is: its kind, the value of Embree's geomID, and which of that kind. Nothing is met by a ray that meets NONE.
enum Kind : unsigned { SPHERES = 0, BOXES = 1, PLANES = 2, NONE = RTC_INVALID_GEOMETRY_ID };
struct Shape { unsigned kind = NONE, index = 0; };
bool operator==(Shape a, Shape b) { return a.kind == b.kind && a.index == b.index; }

constexpr unsigned FACES = 6;

// A box is six quads to Embree.
Shape shape_of(unsigned geometry, unsigned primitive) {
    return {geometry, geometry == BOXES ? primitive / FACES : primitive};
}

struct Ray { Vector origin, direction; Shape left; };
struct Hit { Shape shape; double distance = INFINITE; Vector face_normal; };
struct Surface { Vector point, normal; Shape shape; const Material *material; };
struct Counts { unsigned long camera = 0, shadow = 0, reflection = 0; };

// The shape that a ray leaves goes along with it to the filter below.
struct Context { RTCIntersectContext base; Shape left; };

void pass_what_is_left(const RTCFilterFunctionNArguments *query) {
    const Shape left = reinterpret_cast<const Context *>(query->context)->left;
    for (unsigned i = 0; i < query->N; i++) {
        const unsigned geometry = RTCHitN_geomID(query->hit, query->N, i);
        if (shape_of(geometry, RTCHitN_primID(query->hit, query->N, i)) == left) query->valid[i] = 0;
    }
}

void attach(RTCScene world, RTCGeometry geometry, Kind kind) {
    rtcSetGeometryIntersectFilterFunction(geometry, pass_what_is_left);
    rtcSetGeometryOccludedFilterFunction(geometry, pass_what_is_left);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(world, geometry, kind);
    rtcReleaseGeometry(geometry);
}

template <class T> T *new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, size_t size, size_t count) {
    return static_cast<T *>(rtcSetNewGeometryBuffer(geometry, type, 0, format, size, count));
}

void attach_spheres(RTCDevice device, RTCScene world, const std::vector<Sphere> &spheres) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto *vertices = new_buffer<Sphere>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, sizeof(Sphere), spheres.size());
    std::copy(spheres.begin(), spheres.end(), vertices);
    attach(world, geometry, SPHERES);
}

void attach_boxes(RTCDevice device, RTCScene world, const std::vector<Box> &boxes) {
    // Corner k is high in x, y and z where bits 0, 1 and 2 of k are set.
    static const unsigned corners[FACES][4] = {
        {0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
    auto *vertex = new_buffer<float>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 12, boxes.size() * 8);
    auto *index = new_buffer<unsigned>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT4, 16, boxes.size() * FACES);
    for (unsigned i = 0; i < boxes.size(); i++) {
        const Box &box = boxes[i];
        for (unsigned k = 0; k < 8; k++) {
            *vertex++ = float(k & 1 ? box.high.x : box.low.x);
            *vertex++ = float(k & 2 ? box.high.y : box.low.y);
            *vertex++ = float(k & 4 ? box.high.z : box.low.z);
        }
        for (const auto &face : corners)
            for (unsigned corner : face) *index++ = i * 8 + corner;
    }
    attach(world, geometry, BOXES);
}

RTCScene build(RTCDevice device, const Scene &scene) {
    const RTCScene world = rtcNewScene(device);
    rtcSetSceneFlags(world, RTC_SCENE_FLAG_ROBUST);
    if (!scene.spheres.empty()) attach_spheres(device, world, scene.spheres);
    if (!scene.boxes.empty()) attach_boxes(device, world, scene.boxes);
    rtcCommitScene(world);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) fail("Embree cannot build the scene");
    return world;
}

RTCRay single_precision(const Ray &ray, double limit) {
    RTCRay single{};
    single.org_x = float(ray.origin.x), single.org_y = float(ray.origin.y), single.org_z = float(ray.origin.z);
    single.dir_x = float(ray.direction.x), single.dir_y = float(ray.direction.y), single.dir_z = float(ray.direction.z);
    single.tfar = float(limit);
    single.mask = ~0u;
    return single;
}

Context context_of(const Ray &ray) {
    Context context{{}, ray.left};
    rtcInitIntersectContext(&context.base);
    return context;
}

class Renderer {
public:
    Counts counts;

    Renderer(const Scene &scene, RTCScene world) : scene(scene), world(world) {}

    // The colour of a pixel, whose centre lies half a pitch inside the edges of the screen.
    Vector pixel(int column, int row) {
        const Camera &camera = scene.camera;
        const Vector right = normalized(cross(camera.up, camera.view));
        const double pitch = 1 / camera.zoom / scene.height;
        const double x = (column + 0.5 - scene.width / 2.0) * pitch, y = (scene.height / 2.0 - row - 0.5) * pitch;
        counts.camera++;
        return color({camera.eye, normalized(camera.view + right * x + camera.up * y), {}}, 1);
    }

private:
    const Scene &scene;
    const RTCScene world;

    Vector color(const Ray &ray, int generation) {
        const Hit hit = closest(ray);
        if (hit.shape.kind == NONE) return scene.background;
        const Surface surface = surface_at(ray, hit);
        const Material &material = *surface.material;
        Vector sum = material.color * (lit(surface) * material.diffuse + Vector{1, 1, 1} * material.ambient);
        if (material.reflection > 0) sum = sum + reflected(ray, surface, generation) * material.reflection;
        return sum;
    }

    Vector reflected(const Ray &ray, const Surface &surface, int generation) {
        if (generation == scene.depth) return scene.background;
        counts.reflection++;
        const Vector direction = ray.direction - surface.normal * (2 * dot(ray.direction, surface.normal));
        return color({surface.point, direction, surface.shape}, generation + 1);
    }

    Vector lit(const Surface &surface) {
        Vector sum;
        if (surface.material->diffuse <= 0) return sum;
        for (const Light &light : scene.lights) {
            const Vector to_light = light.place - surface.point;
            const double distance = std::sqrt(dot(to_light, to_light));
            const Ray ray{surface.point, to_light * (1 / distance), surface.shape};
            const double cosine = dot(surface.normal, ray.direction);
            if (cosine > 0 && !occluded(ray, distance)) sum = sum + light.color * cosine;
        }
        return sum;
    }

    Hit closest(const Ray &ray) const {
        Context context = context_of(ray);
        RTCRayHit found{};
        found.ray = single_precision(ray, INFINITE);
        found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(world, &context.base, &found);
        Hit hit;
        if (found.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
            hit.shape = shape_of(found.hit.geomID, found.hit.primID);
            hit.distance = found.ray.tfar;
            hit.face_normal = {found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z};
        }
        for (unsigned i = 0; i < scene.planes.size(); i++) {
            const double distance = distance_to_plane(ray, i);
            if (distance > 0 && distance < hit.distance) hit = {{PLANES, i}, distance, scene.planes[i].normal};
        }
        return hit;
    }

    bool occluded(const Ray &ray, double limit) {
        counts.shadow++;
        for (unsigned i = 0; i < scene.planes.size(); i++) {
            const double distance = distance_to_plane(ray, i);
            if (distance > 0 && distance < limit) return true;
        }
        Context context = context_of(ray);
        RTCRay single = single_precision(ray, limit);
        rtcOccluded1(world, &context.base, &single);
        return single.tfar < 0;
    }

    // Infinite where the ray leaves that very plane.
    double distance_to_plane(const Ray &ray, unsigned index) const {
        if (ray.left == Shape{PLANES, index}) return INFINITE;
        const Plane &plane = scene.planes[index];
        return (plane.offset - dot(plane.normal, ray.origin)) / dot(plane.normal, ray.direction);
    }

    Surface surface_at(const Ray &ray, const Hit &hit) const {
        Surface surface{ray.origin + ray.direction * hit.distance, hit.face_normal, hit.shape, nullptr};
        int material = 0;
        if (hit.shape.kind == SPHERES) {
            const Sphere &sphere = scene.spheres[hit.shape.index];
            surface.normal = surface.point - Vector{sphere.x, sphere.y, sphere.z};
            material = scene.sphere_materials[hit.shape.index];
        } else if (hit.shape.kind == BOXES) {
            material = scene.box_materials[hit.shape.index];
        } else {
            material = scene.planes[hit.shape.index].material;
        }
        surface.normal = normalized(surface.normal);
        if (dot(surface.normal, ray.direction) > 0) surface.normal = surface.normal * -1;
        surface.material = &scene.materials[material];
        return surface;
    }
};

unsigned char byte(double value) { return static_cast<unsigned char>(std::floor(std::fmin(1, value) * 255 + 0.5)); }

Counts render(const Scene &scene, RTCScene world, std::ostream &out) {
    Renderer renderer(scene, world);
    out << "P6\n" << scene.width << ' ' << scene.height << "\n255\n";
    for (int row = 0; row < scene.height; row++)
        for (int column = 0; column < scene.width; column++) {
            const Vector color = renderer.pixel(column, row);
            out << byte(color.x) << byte(color.y) << byte(color.z);
        }
    return renderer.counts;
}

} // namespace

int main(int count, char **arguments) {
    if (count != 3) fail("usage: embree IN.nsc OUT.ppm");
    const Scene scene = read_scene(arguments[1]);
    const RTCDevice device = rtcNewDevice(nullptr);
    if (!device) fail("Embree does not start");
    const RTCScene world = build(device, scene);
    std::ofstream out(arguments[2], std::ios::binary);
    const Counts counts = render(scene, world, out);
    out.close();
    if (!out) fail(std::string("cannot write ") + arguments[2]);
    std::printf("{\"camera\": %lu, \"shadow\": %lu, \"reflection\": %lu}\n", counts.camera, counts.shadow, counts.reflection);
    rtcReleaseScene(world);
    rtcReleaseDevice(device);
}
