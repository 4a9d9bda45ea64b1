# make -j2 -f reassembly.mk     scanned glass back into its photographs: run/
# A simulated laboratory: a backdrop of 30 x 20 checks, a cloth, a bowl and a
# teapot of glass with lids and markers, lamps round them, an arm with two
# cameras. The pieces go through a simulated tomograph and are cleaned; the
# light comes from photographs of a chrome ball. Then steps, each rendered and
# held against a photograph: run/table.txt, run/figure16.html.
#   a  repositioned, matte surfaces      b  measured surfaces
#   c  the cloth gives way               d  the ball seen in perspective
#   e  its reflectance divided out       f  absorption, by renderings against
#   g  the reference                        a photograph from elsewhere
#   h  what explain finds in f
# LABELS = photographs: which surface is where is found by reassemble, too.
# MAKER is built by `scripts/build release reassembly-maker`. POSES = truth does
# without reassemble; PROBE and SCAN are what stands in for light-probe and
# structured-light: other programs that write the same files may take their
# places. Larger: WIDTH=640 VOXELS=400 SPP=1024 PHOTO_SPP=64.
WIDTH     = 320
VOXELS    = 144
PHOTONS   = 100000
SPP       = 64
PHOTO_SPP = 24
PRESSED   = 0.5
SIGMA     = 0.06
SEED      = 1
ABSORBS   = 0 6 12 18 24
PIECES    = bowl bowl-lid pot pot-lid
MAKER     = reassembly-maker
POSES     = $(if $(shell command -v reassemble),markers,truth)
PROBE     = $(MAKER) unwrap
SCAN      = run/scan.ply
RADIUS    = 2.5mm
DIAMETER  = 5mm
LABELS    = truth

STEPS     = a b c d e f g h
SURFACE   = $(if $(filter pot%,$1),borosilicate,soda)
INDEX     = $(if $(filter pot%,$1),1.47,1.52)
VIEWS     = $(foreach s,1 2 3,s$s-left s$s-right)
CARDS     = white-card grey-card white-cloth blue-cloth stand
LIGHT     = "files": {"room": {"path": "$1.exr", "bytes": null, "sha256": null}}
FILM      = run/photos/front.exr

.RECIPEPREFIX = >
.SECONDEXPANSION:
.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all clean
all: run/table.txt run/figure16.html

# The laboratory, and what it records.
run/truth.json: | run
> $(MAKER) laboratory run $(WIDTH) $(VOXELS) $(PRESSED) $(SIGMA) $(SEED)
run/scan.ply run/scan-pressed.ply run/poses.json run/ball.json run/room.exr \
run/lambertian.json run/measured.json run/believed.json: run/truth.json
> @test -s $@ && touch $@

$(PIECES:%=run/%.nrrd): run/%.nrrd: | run
> $(MAKER) piece $* $(VOXELS) $(PHOTONS) $(SEED) run

run/photos.json: run/truth.json $(PIECES:%=run/%.nrrd)
> render $< --record $(VIEWS:%=--image %) --spp $(PHOTO_SPP) --resume \
>   --aov off --out run/photos | render --record --image front --image held \
>   --spp $(SPP) --seed 2 --resume --preview --out run/photos -o $@

run/photos/front.exr run/photos/held.exr: run/photos.json
> @test -s $@ && touch $@

run/balls.json: run/ball.json
> render $< --record --spp $(PHOTO_SPP) --resume --preview --out run/photos \
>   -o $@

# The pieces.
run/empty.json: | run
> echo '{"gonio": 1}' > $@

$(PIECES:%=run/%.json): run/%.json: run/empty.json run/%.nrrd
> ct-mesh-clean -i $< --name $* --markers $(DIAMETER) --surface \
>   $(call SURFACE,$*) --index $(call INDEX,$*) --reference run/$*-true.ply \
>   --csv run/$*.csv --html run/$*.html --force --out run/pieces -o $@ \
>   run/$*.nrrd

# The light: three ways to unwrap the ball.
run/orthographic.exr: run/balls.json
> $(PROBE) $< orthographic raw $@
run/perspective.exr: run/balls.json
> $(PROBE) $< perspective raw $@
run/divided.exr: run/balls.json
> $(PROBE) $< perspective divided $@
run/light-%.json: | run
> echo '{$(call LIGHT,$*)}' > $@

# The pieces in their places, on the cloth as scanned, and on one that gave way.
run/rig.json: run/photos.json run/believed.json run/light-orthographic.json \
  run/measured.json run/orthographic.exr
> $(MAKER) patch run/photos.json run/believed.json run/measured.json \
>   run/light-orthographic.json > $@

ifeq ($(POSES),truth)
run/flat.json: SOFT = scan
run/given.json: SOFT = scan-pressed
run/flat.json run/given.json: run/rig.json $(PIECES:%=run/%.json) run/poses.json
> $(MAKER) assemble run/rig.json $(SOFT) run/poses.json $(PIECES:%=run/%.json) \
>   > $@
else
LABELLING = $(if $(filter photographs,$(LABELS)),--labels --shading-spp 16 \
            $(CARDS:%=--label-surface %))
run/given.bare.json: CONTACT = --contact elastic
run/flat.bare.json run/given.bare.json: run/rig.json $(PIECES:%=run/%.json) \
  $(SCAN)
> reassemble -i $< $(foreach p,$(PIECES),--piece $p=run/$p.json) \
>   $(VIEWS:%=--image %) --marker-radius $(RADIUS) --contrast dark \
>   --marker-surface marker --background $(SCAN) --background-surface \
>   white-cloth $(CONTACT) $(LABELLING) --force \
>   --html $(@:.bare.json=.html) --out $(@:.bare.json=) -o $@
run/flat.json run/given.json: run/%.json: run/%.bare.json
> $(if $(LABELLING),cat $<,$(MAKER) labelled $< $(SCAN) $*) > $@
endif

# The steps.
run/a.json: run/flat.json run/lambertian.json run/light-orthographic.json
run/b.json: run/flat.json run/measured.json run/light-orthographic.json
run/c.json: run/given.json run/measured.json run/light-orthographic.json
run/d.json: run/c.json run/light-perspective.json run/perspective.exr
run/e.json: run/c.json run/light-divided.json run/divided.exr
run/f.json: run/e.json run/soda.json run/borosilicate.json
run/h.json: run/f.json run/mechanisms.json
$(patsubst %,run/%.json,a b c d e f h): run/%.json:
> $(MAKER) patch $(filter %.json,$^) > $@

run/g.json: run/truth.json run/photos.json
> cp $< $@

run/pictures/%/front.exr: run/%.json
> render $< --image front --spp $(SPP) --force --preview \
>   --out $(@D) > /dev/null

run/%.compared: run/pictures/%/front.exr $(FILM)
> compare --reference $(FILM) --rendered $< --gain 16000 --read 0.0005 \
>   --exposure-scale $$($(MAKER) scale $(FILM) $<) \
>   --force --out run/errors/$* --html run/$*.html > $@

# Absorption: small renderings of a held-out view with so much of it in one
# glass, per m; each channel has a parabola of its own, as all are linear.
ABSORB    = $(foreach k,$(ABSORBS),run/absorb/$1-$k.txt)
run/absorb/%.json: run/e.json \
  $$(if $$(findstring borosilicate,$$*),run/soda.json)
> mkdir -p $(@D); s=$*; echo "{\"surfaces\": {\"$${s%-*}\": \
>   {\"sigma_a_per_m\": $${s##*-}}}}" > $@.part
> $(MAKER) patch $(filter %.json,$^) $@.part > $@.whole
> sed 's|"path": "|&../|' $@.whole > $@; rm $@.part $@.whole
run/absorb/%.txt: run/absorb/%.json run/photos/held.exr
> render $< --image held --spp $(SPP) --allow-outside --force --aov off \
>   --out run/absorb/$* > /dev/null
> x=$$($(MAKER) scale run/photos/held.exr run/absorb/$*/held.exr); \
>   for c in red green blue; do compare --reference run/photos/held.exr \
>   --rendered run/absorb/$*/held.exr --exposure-scale $$x --channels $$c | \
>   awk -v c=$$c '/"rmse":/ && !n++ {split($$0, x, ": "); print c, x[2] + 0}'; \
>   done > $@

run/soda.json run/borosilicate.json: run/%.json: $$(call ABSORB,$$*)
> awk -v s=$* '{k = FILENAME; sub(/.*-/, "", k); y = $$2 ^ 2; n[$$1]++; \
>   for (p = 0; p <= 4; p++) S[$$1, p] += k ^ p; \
>   for (p = 0; p <= 2; p++) T[$$1, p] += y * k ^ p} \
>   function best(c, a, b, d, e, f, m, u, v, w, det) {a = S[c, 4]; b = S[c, 3]; \
>   d = S[c, 2]; e = S[c, 1]; f = n[c]; u = T[c, 2]; v = T[c, 1]; w = T[c, 0]; \
>   det = a * (d * f - e * e) - b * (b * f - e * d) + d * (b * e - d * d); \
>   m = (u * (d * f - e * e) - b * (v * f - e * w) + d * (v * e - d * w)) / det; \
>   b = (a * (v * f - e * w) - u * (b * f - e * d) + d * (b * w - v * d)) / det; \
>   return m > 0 && b < 0 ? -b / (2 * m) : 0} \
>   END {print "{\"surfaces\": {\"" s "\": {\"sigma_a_per_m\": [" \
>   best("red") ", " best("green") ", " best("blue") "]}}}"}' $^ > $@

# What is left: explain on the held-out view. Where it does not simulate such a
# picture (65) it is asked about the pixels, as multiples of what was rendered.
run/pictures/f/held.exr: run/f.json
> render $< --image held --spp $(SPP) --force --preview \
>   --out $(@D) > /dev/null
run/explained.json: run/f.json run/pictures/f/held.exr run/photos/held.exr
> explain $< --html run/explain.html --force -o $@ 2> run/explain.txt; s=$$?; \
>   cat run/explain.txt; test $$s -le 2 || { test $$s -eq 65 && $(MAKER) pixels \
>   run/photos/held.exr run/pictures/f/held.exr > run/pixels.csv && { explain \
>   run/pixels.csv --model 'a*rendered' --observed photographed --group series \
>   --free a=1 --html run/explain.html --force -o $@ || test $$? -le 2; }; }
run/mechanisms.json: run/explained.json
> $(MAKER) take $< mechanisms > $@

HOW_a = poses: $(POSES); surfaces: their bihemispherical reflectance
HOW_b = surfaces: from truth; labels: $(if $(filter \
        truth,$(POSES)),truth,$(LABELS))
HOW_c = background: from truth + noise; gave way: $(if $(filter \
        truth,$(POSES)),from truth + noise,reassemble)
HOW_d = $(firstword $(PROBE))
HOW_e = $(firstword $(PROBE))
HOW_f = render | compare on a held-out view
HOW_g = the truth, rendered with other noise
HOW_h = explain
# beyond: what is left of the rmse once that of g, noise alone, is taken off.
run/table.txt: $(STEPS:%=run/%.compared)
> { $(foreach s,$(STEPS),echo '$s $(HOW_$s)';) } > $@.part
> awk 'FILENAME ~ /part$$/ {s = $$1; sub(/^[^ ]+ /, ""); how[s] = $$0; \
>   order[++m] = s; next} {s = FILENAME; gsub(/run\/|\.compared/, "", s)} \
>   match($$0, /"(rmse|ssim|log10_error|exposure_scale)":/) {k = substr($$0, \
>   RSTART + 1, RLENGTH - 3); if (!((s, k) in v)) {split($$0, x, ": "); \
>   v[s, k] = x[2] + 0}} END {print "step beyond rmse ssim log10_error " \
>   "exposure how"; for (i = 1; i <= m; i++) {s = order[i]; d = v[s, "rmse"] ^ 2 \
>   - v["g", "rmse"] ^ 2; print s, sprintf("%.4f", d > 0 ? sqrt(d) : 0), \
>   v[s, "rmse"], v[s, "ssim"], v[s, "log10_error"], v[s, "exposure_scale"], \
>   how[s]}}' $@.part $^ > $@
> cat $@; rm $@.part

run/figure16.html: run/table.txt
> { echo '<!doctype html><title>Step by step</title><table>'; \
>   awk 'NR > 1 {h = ""; for (i = 7; i <= NF; i++) h = h " " $$i; \
>   print "<tr><th>" $$1 \
>   "<td><img src=pictures/" $$1 "/front.png><td><img src=errors/" $$1 \
>   "/front-log10-error.png><td>RMSE " $$3 \
>   " (beyond noise " $$2 ")<br>SSIM " $$4 "<br>log error " $$5 \
>   "<br>" h}' $<; echo '</table>'; } > $@

run:
> mkdir -p run

clean:
> rm -rf run
