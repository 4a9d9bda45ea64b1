// See call.h.
#include "tools/brdf-fit/call.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <map>

#include "base/atomic_file.h"
#include "base/progress.h"
#include "base/text.h"
#include "goniometry/document.h"
#include "goniometry/plan.h"
#include "goniometry/plots.h"
#include "goniometry/sample/recording.h"
#include "goniometry/spectra.h"
#include "goniometry/tables/sample_table.h"
#include "io/picture.h"
#include "manifest/fields.h"
#include "manifest/sections/flat_patch.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/table.h"
#include "render/preview.h"
#include "report/heat_drawing.h"
#include "tools/brdf-fit/page.h"

namespace gonio::tools::brdf_fit {

using namespace gonio::goniometry;
using goniometry::Basis;

namespace {

namespace fs = std::filesystem;

// That change what a table says.
constexpr std::array<const char*, 6> reading_options = {"columns", "angles", "bands", "mirror", "grazing", "noise"};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    if (end > at) parts.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

TableOptions table_options(const cli::Invocation& call) {
  TableOptions options;
  for (const std::string& text : call.texts("columns"))
    for (ColumnUse& use : parse_columns(text, "--columns")) options.columns.push_back(std::move(use));
  if (call.given("angles")) options.angles = call.text("angles");
  for (const std::string& text : call.texts("bands"))
    for (std::string& band : split(text)) options.bands.push_back(std::move(band));
  const std::string& mirror = call.text("mirror");
  options.mirror = mirror == "auto" ? Mirror::automatic : mirror == "0" ? Mirror::same : Mirror::opposite;
  options.grazing_rad = call.number("grazing");
  if (call.given("noise")) options.relative_noise = call.number("noise");
  return options;
}

FitOptions fit_options(const cli::Invocation& call) {
  FitOptions options;
  options.models = call.texts("model");
  options.lobes = static_cast<int>(call.integer("lobes"));
  if (call.flag("isotropic")) options.anisotropic = false;
  if (call.flag("anisotropic")) options.anisotropic = true;
  options.random_starts = static_cast<int>(call.integer("starts"));
  options.folds = static_cast<int>(call.integer("folds"));
  const std::string& scale = call.text("scale");
  options.scale = scale == "noise"   ? Scale::noise
                  : scale == "log1p" ? Scale::log1p
                  : scale == "log10" ? Scale::log10
                                     : Scale::automatic;
  options.seed = call.seed;
  return options;
}

Basis basis_for(cli::Invocation& call, const Bins& bins) {
  if (!call.given("basis")) {
    log(LogLevel::info, "generating the built-in basis from analytic models; --basis names measured tables");
    return builtin_basis({.bins = bins, .seed = call.seed});
  }
  const fs::path path = call.text("basis");
  if (fs::is_directory(path)) return basis_of_folder(path);
  if (!fs::exists(path))
    throw Error(Exit::no_input, "--basis", "\"" + path.string() + "\" does not exist",
                "name a folder of MERL tables, or a basis that was saved");
  call.note_input(path);
  return Basis::load(path);
}

// What is measured, one entry for each surface to be told.
std::vector<Outcome> read_inputs(cli::Invocation& call) {
  const TableOptions options = table_options(call);
  std::vector<Outcome> outcomes;
  const auto add = [&](const std::string& name, const std::string& source, ReadTable read) -> Outcome& {
    outcomes.push_back({.name = name, .source = source, .read = std::move(read)});
    return outcomes.back();
  };
  const bool as_it_is = std::ranges::none_of(reading_options, [&](const char* option) { return call.given(option); });
  for (const std::string& file : call.texts("FILE")) {
    const fs::path path = file;
    call.note_input(path);
    Outcome& outcome = add(path.stem().string(), path.filename().string(), read_table(path, options));
    if (as_it_is && describes_itself(path)) outcome.file = path;
  }
  if (!outcomes.empty() || !call.has_document) return outcomes;
  const std::vector<std::string>&tables = call.texts("table"), &samples = call.texts("sample");
  const bool all = tables.empty() && samples.empty();
  for (const auto& [name, table] : call.document.tables)
    if (all ? table.model == "surface" : std::ranges::find(tables, name) != tables.end())
      add(table.surface.empty() ? name : table.surface, "tables/" + name, read_table(call.document, name, options))
          .table_name = name;
  for (const auto& [name, patch] : call.document.goniometer) {
    const bool tile = !patch.reflectance.empty() || !patch.surface.empty();
    if (all ? tile : std::ranges::find(samples, name) == samples.end()) continue;
    ReduceOptions reducing;
    reducing.sample = name, reducing.max_theta_rad = options.grazing_rad;
    Reduced reduced = reduce(call.document, reducing);
    keep_bands(reduced.samples, options.bands, "--bands");
    ReadTable read{std::move(reduced.samples), std::move(reduced.dropped), {}, std::move(reduced.notes)};
    read.convention.from = Convention::From::format;
    add(name, "goniometer/" + name, std::move(read));
  }
  for (const std::string& name : tables)
    if (!call.document.tables.contains(name))
      throw Error(Exit::data, "--table", "\"" + name + "\" is not in tables of " + call.document.name);
  for (const std::string& name : samples)
    if (!call.document.goniometer.contains(name))
      throw Error(Exit::data, "--sample", "\"" + name + "\" is not in goniometer of " + call.document.name);
  return outcomes;
}

// What a person would want to know before the numbers: which rows do not count, and an unlikely convention.
void log_reading(const Outcome& outcome) {
  std::map<std::string, std::size_t> reasons;
  for (const Dropped& dropped : outcome.read.dropped) ++reasons[dropped.reason];
  std::string why;
  for (const auto& [reason, rows] : reasons) why += (why.empty() ? "" : ", ") + std::to_string(rows) + " " + reason;
  const std::size_t left_out = outcome.read.dropped.size();
  if (left_out > 0)
    log(LogLevel::info, outcome.name + ": " + std::to_string(left_out) + " of " +
                            std::to_string(left_out + outcome.read.samples.rows()) +
                            " pairs of directions are left out: " + why);
  if (!outcome.read.units_doubt.empty()) log(LogLevel::warning, outcome.name + ": " + outcome.read.units_doubt);
  if (outcome.read.convention.contradicted)
    log(LogLevel::warning, outcome.name + ": " + outcome.read.convention.sentence);
}

void tell(cli::Invocation& call, Outcome& outcome, const std::optional<Basis>& basis) {
  if (!basis) {
    outcome.fits = fit_surfaces(outcome.read.samples, fit_options(call));
    return;
  }
  ReconstructOptions options;
  if (call.given("noise")) options.relative_noise = call.number("noise");
  outcome.reconstruction = reconstruct(*basis, outcome.read.samples, options);
  outcome.basis = basis->description();
  // The reader of tables refuses what returns more light than it receives; the verdict says it instead.
  outcome.table_scale = std::max(1.0, outcome.reconstruction->energy.most);
  io::MerlTable within = outcome.reconstruction->table;
  for (float& f : within.brdf_per_sr) f = f < 0 ? f : static_cast<float>(static_cast<double>(f) / outcome.table_scale);
  outcome.table = std::make_shared<const surface::MeasuredTable>(std::move(within), outcome.name);
}

std::string named(const Outcome& outcome, const std::string& ending) {
  return file_stem(outcome.name) + ending;
}

// Before the fits, which take their time: names that two samples share, and files that are there.
void check_names(const cli::Invocation& call, const std::vector<Outcome>& outcomes) {
  std::map<std::string, const Outcome*> known;
  for (const Outcome& outcome : outcomes) {
    const auto [other, fresh] = known.try_emplace(file_stem(outcome.name), &outcome);
    if (!fresh)
      throw Error(Exit::data, outcome.source,
                  "would be called \"" + outcome.name + "\", and so would " + other->second->source,
                  "fit one after the other with --name, or rename a file");
    const fs::path csv = call.out / named(outcome, ".csv");
    if (!call.out.empty() && fs::exists(csv) && !call.force && !call.resume)
      throw Error(Exit::cannot_create, csv.string(), "exists", "--force replaces it");
  }
}

// Where a file goes: named by the user, else below --out, else nowhere.
fs::path path_for(cli::Invocation& call, const std::string& option, const std::string& name) {
  if (!option.empty() && call.given(option)) return call.text(option);
  return call.out.empty() ? fs::path() : call.output_path(name);
}

void write_below(cli::Invocation& call, Outcome& outcome, const std::string& key, const fs::path& path,
                 const std::string& bytes) {
  if (path.empty()) return;
  write_file(path, bytes);
  outcome.files[key] = manifest::add_file(call.document, path, outcome.name + "-" + key);
}

void write_drawings(cli::Invocation& call, Outcome& outcome) {
  const auto draw = [&](const std::string& what, const std::string& svg) {
    write_below(call, outcome, what, call.output_path(named(outcome, "-" + what + ".svg")), svg);
  };
  const std::size_t band = written_bands(outcome.read.samples)[1];
  if (const auto scans = scan_plot(outcome, band)) draw("scans", standalone_svg(*scans));
  draw("lobes", standalone_svg(lobe_plot(outcome, band)));
  draw("residuals", report::standalone_svg(residual_map(outcome)));
  if (outcome.reconstruction) return;
  for (const auto& [number, plot] : spectra_of(outcome)) draw("spectrum-" + number, standalone_svg(plot));
}

void write_outputs(cli::Invocation& call, Outcome& outcome) {
  std::string table_file;
  const bool whole = outcome.reconstruction.has_value();
  const fs::path merl = whole                ? path_for(call, "merl", named(outcome, ".binary"))
                        : call.given("merl") ? fs::path(call.text("merl"))
                                             : fs::path();
  if (!merl.empty() && (whole || outcome.chosen() != nullptr)) {
    io::write_merl(merl, merl_of(outcome, "--merl"));
    outcome.files["merl"] = table_file = manifest::add_file(call.document, merl, outcome.name + "-merl");
  }
  if (const fs::path sigma = whole ? path_for(call, "merl-sigma", named(outcome, "-sigma.binary")) : fs::path();
      !sigma.empty()) {
    io::write_merl(sigma, outcome.reconstruction->sigma);
    outcome.files["merl_sigma"] = manifest::add_file(call.document, sigma, outcome.name + "-merl-sigma");
  }
  enter(call.document, outcome, table_file);
  write_below(call, outcome, "csv", path_for(call, "csv", named(outcome, ".csv")), samples_csv(outcome));
  if (!whole && outcome.chosen() != nullptr)
    write_below(call, outcome, "numbers", path_for(call, "", named(outcome, "-numbers.csv")), numbers_csv(outcome));
  const fs::path page = path_for(call, "html", named(outcome, ".html"));
  const bool known =
      call.document.surfaces.contains(outcome.name) && outcome.renders() && (whole || outcome.chosen() != nullptr);
  io::Image sphere;
  if (known && !page.empty()) sphere = sphere_picture(call.document, outcome.name);
  if (known && !call.out.empty()) {
    write_below(call, outcome, "sphere", call.output_path(named(outcome, "-sphere.png")),
                io::encode_png(render::preview(sphere)));
    write_drawings(call, outcome);
  }
  write_below(call, outcome, "page", page, page_of(outcome, sphere));
  enter(call.document, outcome, table_file);  // with the files
  if (whole || outcome.chosen() != nullptr) enter_table(call.document, outcome);
}

Exit print_plan(cli::Invocation& call) {
  call.writes_document = false;
  std::vector<Outcome> given;
  if (!call.texts("FILE").empty() || call.has_document) given = read_inputs(call);
  if (given.size() > 1)
    throw Error(Exit::usage, "--plan", "is for one surface, and " + std::to_string(given.size()) + " are given",
                "give one table, or name one with --table or --sample");
  const Basis basis = basis_for(call, {30, 30, 60});
  PlanOptions options;
  if (!given.empty()) options.given = &given.front().read.samples;
  options.most_theta_rad = std::min(call.number("grazing"), 80 * pi / 180);
  if (call.given("noise")) options.relative_noise = call.number("noise");
  const Plan found = plan(basis, static_cast<std::size_t>(call.integer("plan")), options);
  if (!given.empty())
    log(LogLevel::info, format("with what is measured, sigma_ln is %.3f; with these pairs as well, %.3f", found.before,
                               found.sigma_ln.back()));
  std::cout << plan_csv(found) << std::flush;
  return Exit::done;
}

}  // namespace

void check(cli::Invocation& call) {
  if (call.flag("example") || call.given("plan")) return;
  for (const std::string& text : call.texts("columns")) parse_columns(text, "--columns");
  for (const std::string& id : call.texts("model")) {
    std::vector<std::string> known;
    for (const manifest::ModelInfo* model : manifest::models(manifest::Family::surface)) known.push_back(model->id);
    if (std::ranges::find(known, id) == known.end())
      throw Error(Exit::usage, "--model", "\"" + id + "\" is no surface", manifest::remedy_for(id, known));
  }
  const std::size_t files = call.texts("FILE").size();
  if (files == 0 && !call.has_document)
    throw Error(Exit::no_input, "brdf-fit", "has nothing to read",
                "name a table, or a manifest with tables or goniometer; brdf-fit --example prints a table to try");
  for (const char* option : {"merl", "merl-sigma", "csv", "html", "name"})
    if (files > 1 && call.given(option))
      throw Error(Exit::usage, "--" + std::string(option), "is one, and there are " + std::to_string(files) + " tables",
                  "use --out DIR, or give one table");
  for (const char* option : {"merl", "merl-sigma", "save-basis", "csv", "html"})
    if (call.given(option)) check_writable(call.text(option));
  if (call.flag("reconstruct") && !call.given("merl") && call.out.empty())
    throw Error(Exit::usage, "--reconstruct", "has no place for its table", "name one: --merl FILE, or --out DIR");
}

Exit run(cli::Invocation& call) {
  if (call.flag("example")) {
    call.writes_document = false;
    std::cout << example_table(call.seed) << std::flush;
    return Exit::done;
  }
  if (call.given("plan")) return print_plan(call);
  std::vector<Outcome> outcomes = read_inputs(call);
  if (outcomes.empty())
    throw Error(Exit::data, call.document.name, "has no tables of model \"surface\" and no goniometer samples",
                "name one with --table, or give a table of reflectances");
  if (call.given("name")) outcomes.front().name = call.text("name");
  check_names(call, outcomes);
  std::optional<Basis> basis;
  if (call.flag("reconstruct")) basis = basis_for(call, merl_bins);
  if (basis && call.given("save-basis")) basis->save(call.text("save-basis"));
  Exit worst = Exit::done;
  for (Outcome& outcome : outcomes) {
    log_reading(outcome);
    tell(call, outcome, basis);
    write_outputs(call, outcome);
    const Verdict verdict = verdict_of(outcome);
    log(verdict.exit == Exit::done ? LogLevel::info : LogLevel::warning, verdict.sentence);
    if (!outcome.reconstruction && !outcome.fits.untold.empty())
      log(LogLevel::info, outcome.name + ": not asked: " + outcome.fits.untold);
    if (verdict.exit == Exit::negative || worst == Exit::done) worst = verdict.exit;
  }
  return worst;
}

}  // namespace gonio::tools::brdf_fit
