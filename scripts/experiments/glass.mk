# make -j2 -f glass.mk        pictures of glass for learning, below run/set
# OBJECTS x VIEWS cells in PARTS parts, which run beside each other, here or on
# other machines (scripts/slurm); then the tensors, the table and the page.
# What was interrupted goes on where it ended.
OBJECTS = 400
VIEWS   = 5
SIZE    = 128x128
NOISE   = 10%
SPP     = 512
SEED    = 1
PARTS   = 64
MORE    =
MAKE_GLASS = glass-make --objects $(OBJECTS) --views $(VIEWS) --size $(SIZE) \
  --noise $(NOISE) --spp $(SPP) --seed $(SEED) $(MORE) --threads 1 --resume \
  --out run/set

PARTS_LIST := $(shell seq 1 $(PARTS))

.RECIPEPREFIX = >
.PHONY: all clean
all: run/set.json

$(PARTS_LIST:%=run/part-%.json): run/part-%.json: | run
> $(MAKE_GLASS) --shard $*/$(PARTS) -o $@

run/set.json: $(PARTS_LIST:%=run/part-%.json)
> $(MAKE_GLASS) --gather -o $@

run:
> mkdir -p run

clean:
> rm -rf run
