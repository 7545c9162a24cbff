// A neutral scene (.nsc, from generate.py), as read by the programs on Embree.

#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

struct Vector {
    double x = 0, y = 0, z = 0;
};

inline Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector operator*(Vector a, Vector b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vector operator*(Vector a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector cross(Vector a, Vector b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline Vector normalized(Vector a) { return a * (1 / std::sqrt(dot(a, a))); }

struct Camera { Vector eye, view, up; double zoom = 1; };
struct Light { Vector place, color; };
struct Material { Vector color; double ambient, diffuse, reflection; };
struct Plane { Vector normal; double offset; int material; };
struct Sphere { float x, y, z, radius; };
struct Box { Vector low, high; };

struct Scene {
    int width = 0, height = 0, depth = 1;
    Vector background;
    Camera camera;
    std::vector<Light> lights;
    std::vector<Material> materials;
    std::vector<Plane> planes;
    std::vector<Sphere> spheres;
    std::vector<Box> boxes;
    std::vector<int> sphere_materials, box_materials;
};

[[noreturn]] inline void fail(const std::string &message) {
    std::fprintf(stderr, "%s\n", message.c_str());
    std::exit(1);
}

inline std::istream &operator>>(std::istream &in, Vector &v) { return in >> v.x >> v.y >> v.z; }

inline Scene read_scene(const char *path) {
    std::ifstream in(path);
    Scene scene;
    std::string word;
    while (in >> word) {
        if (word == "res") in >> scene.width >> scene.height;
        else if (word == "depth") in >> scene.depth;
        else if (word == "bg") in >> scene.background;
        else if (word == "camera") {
            Vector target;
            in >> scene.camera.eye >> scene.camera.view >> scene.camera.up >> scene.camera.zoom >> target;
        } else if (word == "light") {
            Light light;
            in >> light.place >> light.color;
            scene.lights.push_back(light);
        } else if (word == "mat") {
            Material material;
            in >> material.color >> material.ambient >> material.diffuse >> material.reflection;
            scene.materials.push_back(material);
        } else if (word == "plane") {
            Plane plane;
            in >> plane.normal >> plane.offset >> plane.material;
            scene.planes.push_back(plane);
        } else if (word == "sphere") {
            Sphere sphere;
            in >> sphere.x >> sphere.y >> sphere.z >> sphere.radius >> scene.sphere_materials.emplace_back();
            scene.spheres.push_back(sphere);
        } else if (word == "box") {
            Box box;
            in >> box.low >> box.high >> scene.box_materials.emplace_back();
            scene.boxes.push_back(box);
        } else fail("unknown word " + word);
        if (!in) fail("cannot read a " + word);
    }
    if (scene.width < 1 || scene.height < 1) fail(std::string("no scene in ") + path);
    return scene;
}
