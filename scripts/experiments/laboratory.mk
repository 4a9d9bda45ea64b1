# make -j2 -f laboratory.mk     four acquisitions on simulated instruments
# a  a light arc round a sample, into brdf-fit: run/sample.json
# b  two arms, calibrated on a board, then a knot into render and compare:
#    run/compared.json
# c  a sheet that bends, photographed from six paths of a camera, its points
#    followed through the pictures, into the solvers, beside the same points as
#    geometry has them: run/shapes.json
# d  a varnished knot on a turntable before a camera behind polarizers, into
#    render and compare: run/polarized.json
# Smaller than the real ones, which are STEP=7.5deg EDGES='' (2,783 views),
# SPP=256 and VIEWS=241.
STEP  = 22.5deg
EDGES = ,steepest=22.5deg,flattest=67.5deg,nearest=22.5deg
SPP   = 16
VIEWS = 97
SOLVERS = rigid csf
SPREAD_circle = 0.3
PATHS = circle half-circle line flyby zigzag tricky
BOARD = --charuco 9x7 --square 20mm --marker 15mm --dictionary 4X4_50
KNOT  = azimuth=200deg,span=60deg,step=30deg,lowest=50deg,highest=50deg$\
        ,radius=36cm,lamp-radius=42cm,lamp-step=40deg,lamp-lowest=50deg$\
        ,lamp-azimuth=-30deg,lamp-span=60deg
TURN  = step=60deg,radius=24cm,azimuth=90deg,lowest=45deg,highest=45deg

.RECIPEPREFIX = >
.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all clean
all: run/sample.json run/compared.json run/shapes.json run/polarized.json

run/arc.json run/studio.json run/stage.json run/turntable.json: run/%.json: | run
> acquire --specimen $* --out run/$* --force -o $@

# a: two exposures, since a varnish is bright in its mirror direction.
run/arc-plan.json: run/arc.json
> acquire $< --plan arc:step=$(STEP)$(EDGES) --target 0m,4.25mm,0m \
>   --exposure 2ms --exposure 16ms --html run/arc-plan.html -o $@

run/arc-frames.json: run/arc-plan.json
> acquire $< --go --spp $(SPP) --resume --out run/arc-frames -o $@

run/sample.json: run/arc-frames.json
> brdf-fit $< --sample sample --isotropic --html run/sample.html -o $@

# b: 2: some views of the board are out of reach.
run/board-plan.json: run/studio.json
> acquire $< --plan board:views=14,tilt=30deg,nearest=25cm,farthest=35cm \
>   -o $@ || test $$? -eq 2

run/mounted.json: run/board-plan.json
> acquire $< --go --truth run/studio/board.json --spp $(SPP) --resume \
>   --out run/board | calib-charuco $(BOARD) --force --out run/corners | \
>   handeye --html run/handeye.html -o $@

run/knot-plan.json: run/mounted.json
> acquire $< --fresh --plan octant:$(KNOT) --target 0m,0m,3cm -o $@

run/knot.json: run/knot-plan.json run/studio.json
> acquire $< --go --truth run/studio.json --spp $(SPP) --resume \
>   --out run/knot -o $@

run/compared.json: run/knot.json
> render $< --spp $(SPP) --resume --out run/rendered | \
>   compare --html run/compared.html -o $@

# c: the drive turns once while the camera goes its way, and every 4th picture
# is a frame; all the way round is beyond the arm's reach.
run/sheet.json: run/stage.json
> nrsfm-make --object sheet --kind bending --frames 40 --force --out run/sheet \
>   -i $< -o $@

$(PATHS:%=run/%-frames.json): run/%-frames.json: run/stage.json run/sheet.json
> acquire $< --plan $*:views=$(VIEWS),distance=36cm,spread=$(or $(SPREAD_$*),0.5),turn=360deg \
>   --target 0m,0m,6cm --exposure 25ms -o run/$*-plan.json || test $$? -eq 2
> acquire run/$*-plan.json --go --truth run/sheet.json --spp $(SPP) --resume \
>   --out run/$* -o $@

$(PATHS:%=run/%-shapes.json): run/%-shapes.json: run/%-frames.json
> nrsfm-make --follow $* --truth run/sheet.json --object sheet --every 4 \
>   --points 200 --least-seen 50% --resume --out run/tracks -i $< | \
>   nrsfm-solve $(SOLVERS:%=--solver %) --resume --out run/shapes -o $@ || test $$? -eq 2

run/shapes.json: $(PATHS:%=run/%-shapes.json)
> for p in $(PATHS); do nrsfm-eval --centre --measure robust-rms --draws 0 \
>   --csv run/$$p.csv --force -i run/$$p-shapes.json > /dev/null || exit 1; done
> nrsfm-eval $(PATHS:%=--table run/%.csv) --model main --html run/shapes.html -o $@

# d
run/turntable-plan.json: run/turntable.json
> acquire $< --plan turntable:$(TURN) --target 0m,0m,3cm -o $@

run/turntable-frames.json: run/turntable-plan.json
> acquire $< --go --spp $(SPP) --resume --out run/polarized -o $@

run/polarized.json: run/turntable-frames.json
> render $< --stokes --spp $(SPP) --resume --out run/stokes | \
>   compare --html run/polarized.html -o $@

run:
> mkdir -p run

clean:
> rm -rf run
