// The scene's camera, from core's record in the arena.
//: use scene::arrays
//: use sensor

fn scene_camera(at: u32) -> Camera {
    return Camera(
        scene_triple(at),
        scene_float(at + 3u),
        scene_triple(at + 4u),
        scene_float(at + 7u),
        scene_triple(at + 8u),
        scene_word(at + 11u),
        scene_triple(at + 12u),
        scene_word(at + 15u),
    );
}
