// cloud-mesh: one triangle mesh of measured clouds, which states its own error (lib/mesh/reconstruct).
#include "cli/program.h"

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "cli/viewpoints.h"
#include "mesh/reconstruct/cloud_document.h"

namespace gonio::tools::cloud_mesh {
namespace {

using cli::Type;

mesh::CloudMeshRequest request_of(cli::Invocation& call) {
  mesh::CloudMeshRequest request;
  request.clouds = call.texts("view");
  request.viewpoints_m = cli::viewpoints_m(call);
  request.name = call.text("name");
  request.wish.chain = call.text("chain") == "thesis" ? mesh::Chain::thesis : mesh::Chain::gonio;
  request.wish.depth = static_cast<int>(call.integer("depth"));
  request.wish.samples = static_cast<std::size_t>(call.integer("samples"));
  request.wish.neighbours = static_cast<std::size_t>(call.integer("neighbours"));
  request.wish.trim = call.number("trim");
  request.wish.least_share = call.number("least-share");
  request.wish.seed = call.seed;
  if (call.given("html")) request.page = call.text("html");
  request.output_path = [&call](const std::string& name) { return call.output_path(name); };
  request.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  return request;
}

void check(cli::Invocation& call) {
  if (!call.has_document)
    throw Error(Exit::usage, "manifest", "is missing", "-i scan.json: what structured-light wrote");
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "say where the mesh goes: --out mesh");
  if (has_entry(call.document, "meshes", call.text("name")) && !call.force)
    throw Error(Exit::data, call.document.name + "#/meshes/" + call.text("name"), "is there already",
                "--name another one, or --force replaces it");
  mesh::check_cloud_mesh(call.document, request_of(call));
}

Exit run(cli::Invocation& call) {
  const mesh::CloudMeshSummary made = mesh::cloud_mesh_document(call.document, request_of(call));
  if (!made.surface) {
    log(LogLevel::warning, "the points make no surface: they lie on a line or at a place, or too far apart (--trim)");
    return Exit::negative;
  }
  const double limit = call.number("limit");
  if (made.whitened <= limit) return Exit::done;
  log(LogLevel::warning, format("points lie off the mesh by %.3g mm, %.3g times what they state (limit %.3g)%s",
                                1e3 * made.rms_m, made.whitened, limit,
                                made.noise_ratio > limit
                                    ? ": neighbouring points contradict each other already, views do not fit together "
                                      "or points state too little; cloud-register says which"
                                    : ": it is smoother than what they show; a greater --depth, or --chain gonio"));
  return Exit::quality;
}

std::vector<cli::Option> options() {
  return {
      {.name = "view",
       .type = Type::text,
       .help = "Cloud to take; may be repeated. Left out: all.",
       .metavar = "NAME",
       .repeat = true},
      cli::viewpoint_option(),
      {.name = "name", .type = Type::text, .help = "Of the mesh.", .metavar = "NAME", .preset = "mesh"},
      {.name = "chain",
       .type = Type::choice,
       .help = "How: ours, or the thesis's to compare with.",
       .preset = "gonio",
       .choices = {"gonio", "thesis"}},
      {.name = "depth",
       .type = Type::integer,
       .help = "Of Poisson's octree: the longest side of the points is 2^DEPTH cells / 1.1 long.",
       .preset = "9",
       .lower = 3,
       .upper = 12},
      {.name = "samples",
       .type = Type::integer,
       .help = "About how many points stay after Poisson-disk resampling: of all views, with --chain thesis of each.",
       .preset = "100000",
       .lower = 100,
       .upper = 1e8},
      {.name = "neighbours",
       .type = Type::integer,
       .help = "Of a plane fit with --chain thesis.",
       .preset = "500",
       .lower = 3,
       .upper = 100000},
      {.name = "trim",
       .type = Type::number,
       .help = "The surface is cut where points lie this many times their usual distance apart.",
       .preset = "4",
       .lower = 1,
       .upper = 1000},
      {.name = "least-share",
       .type = Type::number,
       .help = "Components with a smaller share of the largest one's area are dropped.",
       .preset = "0.01",
       .lower = 0,
       .upper = 1},
      {.name = "limit",
       .type = Type::number,
       .help = "Exit 2 where points lie off the mesh by more than this many times what they state.",
       .preset = "2",
       .lower = 0.1,
       .upper = 1e6},
      {.name = "html", .type = Type::output_file, .help = "Write a report page here."}};
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "cloud-mesh",
      .sentence = "one triangle mesh of measured points, which states its own error",
      .synopsis = {"--out DIR [OPTION]... [-i scan.json]"},
      .options = options(),
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"files", "cameras", "rigs", "images", "clouds"},
      .sections_written = {"files", "meshes"},
      .files =
          {{"NAME.ply",
            "the mesh, with normals; sigma: one standard deviation of a vertex along its normal; deviation: by how "
            "much the points about it lie outside, both in metres; red, green, blue (linear) where the clouds "
            "have them"}},
      .exits = {{Exit::negative, "the points make no surface; nothing was written"},
                {Exit::quality, "points lie off the mesh by more than --limit times what they state"}},
      .references =
          {"Kazhdan & Hoppe, Screened Poisson surface reconstruction, ACM Transactions on Graphics 32(3), 2013.",
           "Corsini, Cignoni & Scopigno, Efficient and flexible sampling with blue noise properties of triangular "
           "meshes, IEEE TVCG 18(6), 2012.",
           "Goldenshluger & Nemirovski, On spatially adaptive estimation of nonparametric regression, Mathematical "
           "Methods of Statistics 6, 1997.",
           "Curless & Levoy, A volumetric method for building complex models from range images, SIGGRAPH 1996."},
      .see_also = {"structured-light(1)", "cloud-register(1)", "reassemble(1)", "render(1)", "gonio-conventions(7)",
                   "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::cloud_mesh
