# make -f ct-cleaning.mk      what cleaning does to refraction, below run/
# A glass teapot goes through a simulated tomograph; its surface is cut out and
# cleaned in four ways, down to as many triangles. Each is rendered as glass
# before checks and held against the true surface: run/table.txt. PHANTOM_MAKER
# is built by `scripts/build release ct-phantom`.
PHANTOM       = teapot
VOXELS        = 192
PHOTONS       = 100000
SEED          = 1
FACES         = 40000
SPP           = 256
MARKERS       = --markers any
WAYS          = none subdivision taubin bounded
PHANTOM_MAKER = ct-phantom

# One view from 90 mm, surroundings of checks.
VIEW = "cameras": {"c": {"width_px": 320, "height_px": 320, "fx_px": 1300, \
  "fy_px": 1300, "cx_px": 159.5, "cy_px": 159.5}}, "lights": {"room": \
  {"model": "lat-long", "file": "room"}}, "images": [{"id": "v", "camera": \
  "c", "world_from_camera": {"matrix": [[1,0,0,0], [0,0,1,-0.09], \
  [0,-1,0,0], [0,0,0,1]]}}]
GLASS = "surfaces": {"glass": {"model": "dielectric", "eta": 1.5}}
PIECE = "meshes": {"piece": {"file": "true"}}, "objects": [{"id": "piece", \
  "mesh": "piece", "surface": "glass"}]

.RECIPEPREFIX = >
.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all clean
all: run/table.txt

run/volume.nrrd: | run
> $(PHANTOM_MAKER) $(PHANTOM) $(VOXELS) $(PHOTONS) $(SEED) run

run/scene.json: run/volume.nrrd
> echo '{"gonio": 1, "files": {"room": {"path": "room.exr"}}, $(VIEW)}' > $@

run/true.json: run/volume.nrrd
> echo '{"gonio": 1, "files": {"room": {"path": "room.exr"}, "true":' \
>   '{"path": "true.ply"}}, $(PIECE), $(GLASS), $(VIEW)}' > $@

# 2: a way that leaves the mesh unsound is measured all the same.
$(WAYS:%=run/%.json): run/%.json: run/scene.json
> ct-mesh-clean -i $< --name piece $(MARKERS) --clean $* --faces $(FACES) \
>   --reference run/true.ply --csv run/$*.csv --html run/$*.html --force \
>   --out run/$* -o $@ run/volume.nrrd || test $$? -eq 2

run/pictures/%/v.exr: run/%.json
> render $< --spp $(SPP) --force --out $(@D) > /dev/null

run/%.compared: run/pictures/%/v.exr run/pictures/true/v.exr
> compare --reference run/pictures/true/v.exr --rendered $< > $@

run/table.txt: $(WAYS:%=run/%.compared)
> echo 'way triangles normals_deg bend_deg bend_median_deg distance_um rmse ssim' > $@
> for w in $(WAYS); do awk -F, -v w=$$w ' \
>   $$1 == "verdict" && $$2 == "triangles" {n = $$3} \
>   $$2 == "normals_rms_rad" {a = $$3 * 57.2958} \
>   $$1 == "reference" && $$2 == "ray_bend_rms_rad" {b = $$3 * 57.2958} \
>   $$2 == "ray_bend_median_rad" {m = $$3 * 57.2958} \
>   $$1 == "reference" && $$2 == "distance_rms_m" {d = $$3 * 1e6} \
>   /"rmse":/ && !r {split($$0, x, ": "); r = x[2] + 0} \
>   /"ssim":/ && !s {split($$1, x, ": "); s = x[2] + 0} \
>   END {print w, n, a, b, m, d, r, s}' run/$$w.csv run/$$w.compared >> $@; done
> cat $@

run:
> mkdir -p run

clean:
> rm -rf run
