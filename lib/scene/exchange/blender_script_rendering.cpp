// The end of the program for Blender: how it renders.
//
// Cycles is asked for what it would give without its conveniences: box filter of one pixel, no clamping, no denoiser,
// no adaptive sampling, no threshold below which lights are skipped, caustics on, 128 bounces of every kind, no view
// transform. Render time is Cycles' own, which it leaves in the picture's header (hh:mm:ss.cc).
#include "scene/exchange/blender_script.h"

namespace gonio::scene {

const std::string_view blender_script_rendering = R"py(def settings(options):
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    cycles.device = "CPU"
    cycles.samples = options.spp
    cycles.seed = options.seed
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.time_limit = 0
    cycles.light_sampling_threshold = 0
    cycles.sample_clamp_direct = 0
    cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    cycles.caustics_reflective = True
    cycles.caustics_refractive = True
    cycles.use_fast_gi = False
    cycles.max_bounces = 128
    cycles.diffuse_bounces = 128
    cycles.glossy_bounces = 128
    cycles.transmission_bounces = 128
    cycles.volume_bounces = 128
    cycles.transparent_max_bounces = 128
    cycles.min_light_bounces = 0
    cycles.min_transparent_bounces = 0
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    cycles.film_exposure = 1.0
    cycles.use_auto_tile = False
    render.film_transparent = False
    render.use_compositing = False
    render.use_sequencer = False
    render.use_motion_blur = False
    render.dither_intensity = 0
    render.threads_mode = "FIXED" if options.threads > 0 else "AUTO"
    if options.threads > 0:
        render.threads = options.threads
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode = "RGB"
    render.image_settings.color_depth = "32"
    render.image_settings.exr_codec = "ZIP"
    scene.view_settings.view_transform = "Raw"
    scene.view_settings.look = "None"


def seconds(text):
    """Of "hh:mm:ss.cc" or "mm:ss.cc"."""
    total = 0.0
    for part in text.split(":"):
        total = 60 * total + float(part)
    return total


def render_time(path):
    """What Cycles states in the header of its picture."""
    with open(path, "rb") as file:
        data = file.read(1 << 16)
    for key in (b".render_time\0string\0",):
        at = data.find(key)
        if at >= 0:
            at += len(key)
            return seconds(data[at + 4:at + 4 + int.from_bytes(data[at:at + 4], "little")].decode("ascii"))
    return None


def main():
    options = arguments()
    found = [image for image in SCENE["images"] if image["id"] == options.image]
    if not found:
        sys.exit('scene.py: --image: no image "%s"' % options.image)
    build(found[0])
    settings(options)
    if not options.out:
        return
    path = os.path.abspath(options.out)
    bpy.context.scene.render.filepath = path
    bpy.context.scene.render.use_file_extension = False
    begin = time.time()
    bpy.ops.render.render(write_still=True)
    wall = time.time() - begin
    own = render_time(path)
    print("render_seconds %s wall_seconds %.3f" % ("unknown" if own is None else "%.2f" % own, wall), flush=True)


main()
)py";

}  // namespace gonio::scene
