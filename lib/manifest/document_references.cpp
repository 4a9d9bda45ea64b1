// See document_references.h.
#include "manifest/document_references.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "manifest/codec.h"
#include "manifest/document_references_parts.h"
#include "manifest/fields.h"
#include "manifest/image_list.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/colour_correction.h"
#include "manifest/sections/environment.h"
#include "manifest/sections/file.h"
#include "manifest/sections/flat_patch.h"
#include "manifest/sections/ground_noise.h"
#include "manifest/sections/image.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/light.h"
#include "manifest/sections/light_position.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/pattern.h"
#include "manifest/sections/placement.h"
#include "manifest/sections/plan.h"
#include "manifest/sections/print.h"
#include "manifest/sections/projection.h"
#include "manifest/sections/reconstruction.h"
#include "manifest/sections/registration.h"
#include "manifest/sections/relief.h"
#include "manifest/sections/rendering.h"
#include "manifest/sections/rig.h"
#include "manifest/sections/robot.h"
#include "manifest/sections/sequence.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/surface_fit.h"
#include "manifest/sections/table.h"
#include "manifest/sections/volume.h"
#include "manifest/units.h"

namespace gonio::manifest {
namespace {

template <class T>
void unique_ids(const std::vector<T>& section, const std::string& place) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < section.size(); ++i)
    if (!seen.insert(section[i].id).second)
      throw Error(Exit::data, item(place, i) + "/id", "\"" + section[i].id + "\" stands twice",
                  "give every entry its own id");
}

void check_images(const Document& d) {
  unique_ids(d.images, place(d, "/images"));
  for (std::size_t i = 0; i < d.images.size(); ++i) {
    const ImageEntry& image = d.images[i];
    const std::string at = place(d, "/images/" + std::to_string(i));
    must_exist(d.files, "files", image.file, at + "/file");
    must_exist(d.files, "files", image.mask, at + "/mask");
    must_exist(d.cameras, "cameras", image.camera, at + "/camera");
    must_exist(d.boards, "boards", image.board, at + "/board");
    for (std::size_t k = 0; k < image.boards.size(); ++k)
      must_exist(d.boards, "boards", image.boards[k].board, at + "/boards/" + std::to_string(k) + "/board");
    must_exist(d.robots, "robots", image.robot, at + "/robot");
    for (const auto& light : image.light) must_exist(d.lights, "lights", light, at + "/light");
  }
}

void check_table(const Table& table, const std::string& at) {
  if (!table.file.empty() && !table.rows.is_null())
    throw Error(Exit::data, at, "has both \"file\" and \"rows\"", "keep one of the two");
  std::vector<std::string> names;
  for (const auto& [name, unit] : table.columns) {
    check_column_unit(name, unit, at + "/columns/" + name);
    names.push_back(name);
  }
  const bool by_its_file = names.empty() && !table.file.empty();  // whose headings are its columns
  for (const auto& name : table.observed)
    if (!by_its_file && std::ranges::find(names, name) == names.end())
      throw Error(Exit::data, at + "/observed", "names column \"" + name + "\", which is not in columns",
                  remedy_for(name, names));
  if (table.rows.is_null()) return;
  expect_array(table.rows, at + "/rows");
  for (std::size_t i = 0; i < table.rows.as_array().size(); ++i) {
    const Value& row = table.rows.as_array()[i];
    if (!row.is_array() || row.as_array().size() != names.size())
      throw Error(Exit::data, item(at + "/rows", i), "is no row of " + std::to_string(names.size()) + " entries",
                  "give one for each column");
  }
}

void check_goniometry(const Document& d) {
  const auto images_exist = [&d](const std::vector<std::string>& ids, const std::string& at) {
    for (const std::string& id : ids)
      if (!index_of_image(d, id))
        throw Error(Exit::data, at + "/images", "names \"" + id + "\", which is not in images");
  };
  for (const auto& [name, patch] : d.goniometer) {
    const std::string at = place(d, "/goniometer/" + name);
    must_exist(d.goniometer, "goniometer", patch.tile, at + "/tile");
    must_exist(d.surfaces, "surfaces", patch.surface, at + "/surface");
    if (patch.polygon_m.empty() == !patch.radius_m)
      throw Error(Exit::data, at, "needs exactly one of \"polygon_m\", \"radius_m\"");
    images_exist(patch.images, at);
  }
  for (const auto& [name, fit] : d.surface_fits)
    for (const auto& [what, file] : fit.files)
      must_exist(d.files, "files", file, place(d, "/surface_fits/" + name + "/files/" + what));
  for (const auto& [name, pattern] : d.patterns) {
    const std::string at = place(d, "/patterns/" + name);
    must_exist(d.files, "files", pattern.file, at + "/file");
    must_exist(d.tables, "tables", pattern.corners, at + "/corners");
    for (std::size_t i = 0; i < pattern.placements.size(); ++i)
      images_exist(pattern.placements[i].images, at + "/placements/" + std::to_string(i));
  }
}

void check_reliefs(const Document& d) {
  for (const auto& [name, relief] : d.reliefs) {
    const std::string at = place(d, "/reliefs/" + name);
    must_exist(d.files, "files", relief.file, at + "/file");
    must_exist(d.tables, "tables", relief.table, at + "/table");
    must_exist(d.surfaces, "surfaces", relief.surface, at + "/surface");
    if (!relief.step_m.empty() && relief.step_m.size() != 2)
      throw Error(Exit::data, at + "/step_m", "has " + std::to_string(relief.step_m.size()) + " numbers",
                  "give two lengths [x, y]");
    for (std::size_t i = 0; i < relief.lobes.size(); ++i)
      must_exist(d.files, "files", relief.lobes[i].picture, at + "/lobes/" + std::to_string(i) + "/picture");
  }
  for (const auto& [name, ground] : d.ground_noises) {
    const std::string at = place(d, "/ground_noises/" + name);
    for (std::size_t i = 0; i < ground.reliefs.size(); ++i)
      must_exist(d.reliefs, "reliefs", ground.reliefs[i], at + "/reliefs/" + std::to_string(i));
    must_exist(d.reliefs, "reliefs", ground.example, at + "/example");
  }
}

void check_prints(const Document& d) {
  for (const auto& [name, print] : d.prints) {
    const std::string at = place(d, "/prints/" + name);
    must_exist(d.files, "files", print.layers, at + "/layers");
    must_exist(d.ground_noises, "ground_noises", print.ground, at + "/ground");
    must_exist(d.reliefs, "reliefs", print.relief, at + "/relief");
    must_exist(d.meshes, "meshes", print.mesh, at + "/mesh");
    must_exist(d.surfaces, "surfaces", print.surface, at + "/surface");
    if (print.pixel_m.size() != 2)
      throw Error(Exit::data, at + "/pixel_m", "has " + std::to_string(print.pixel_m.size()) + " numbers",
                  "give two lengths [x, y]");
    for (std::size_t i = 0; i < print.measured.size(); ++i) {
      const std::string map = at + "/measured/" + std::to_string(i);
      must_exist(d.reliefs, "reliefs", print.measured[i].relief, map + "/relief");
      if (print.measured[i].at_m.size() != 2)
        throw Error(Exit::data, map + "/at_m", "has " + std::to_string(print.measured[i].at_m.size()) + " numbers",
                    "give two lengths [x, y]");
    }
    for (const auto& [key, use] : print.microstructures)
      must_exist(d.files, "files", use.file, at + "/microstructures/" + key + "/file");
    for (std::size_t i = 0; i < print.parts.size(); ++i) {
      const std::string part = at + "/parts/" + std::to_string(i);
      must_exist(d.meshes, "meshes", print.parts[i].mesh, part + "/mesh");
      must_exist(print.microstructures, "microstructures", print.parts[i].microstructure, part + "/microstructure");
      for (const auto& [label, use] : print.parts[i].labels)
        must_exist(print.microstructures, "microstructures", use, part + "/labels/" + label);
    }
  }
}

void needs_numbers(std::size_t count, std::size_t wanted, const std::string& at, const char* remedy) {
  if (count != 0 && count != wanted)
    throw Error(Exit::data, at, "has " + std::to_string(count) + " numbers, needs " + std::to_string(wanted), remedy);
}

void check_colour(const Document& d) {
  for (const auto& [name, colour] : d.colour) {
    const std::string at = place(d, "/colour/" + name);
    must_exist(d.cameras, "cameras", colour.camera, at + "/camera");
    needs_numbers(colour.white.size(), 3, at + "/white", "give R, G, B");
    needs_numbers(colour.offset.size(), 3, at + "/offset", "give R, G, B");
    needs_numbers(colour.gradient.size(), 2, at + "/gradient", "give the change along width and height");
    needs_numbers(colour.curve.size(), 3, at + "/curve", "give width^2, width height, height^2");
    needs_numbers(colour.corners_px.size(), 8, at + "/corners_px", "give x, y of four corners");
    if (colour.matrix.size() != 3)
      throw Error(Exit::data, at + "/matrix", "has " + std::to_string(colour.matrix.size()) + " rows, needs 3",
                  "give one row for each colour that comes out");
    for (std::size_t i = 1; i < 3; ++i)
      needs_numbers(colour.matrix[i].size(), colour.matrix[0].size(), at + "/matrix/" + std::to_string(i),
                    "rows have one column for each term");
  }
}

void check_volumes(const Document& d) {
  for (const auto& [name, volume] : d.volumes) {
    const std::string at = place(d, "/volumes/" + name);
    must_exist(d.files, "files", volume.file, at + "/file");
    for (std::size_t i = 0; i < volume.slices.size(); ++i)
      must_exist(d.files, "files", volume.slices[i], at + "/slices/" + std::to_string(i));
    must_exist(d.meshes, "meshes", volume.mesh, at + "/mesh");
    must_exist(d.meshes, "meshes", volume.reference, at + "/reference");
    must_exist(d.meshes, "meshes", volume.markers_mesh, at + "/markers_mesh");
    needs_numbers(volume.size.size(), 3, at + "/size", "give voxels [i, j, k]");
    needs_numbers(volume.spacing_m.size(), 3, at + "/spacing_m", "give lengths [i, j, k]");
    needs_numbers(volume.tiles.size(), 2, at + "/tiles", "give [columns, rows]");
    if (volume.volume_from_index) {
      const auto& rows = volume.volume_from_index->matrix;
      if (rows.size() != 4)
        throw Error(Exit::data, at + "/volume_from_index/matrix",
                    "has " + std::to_string(rows.size()) + " rows, 4 are needed");
      for (std::size_t i = 0; i < 4; ++i)
        needs_numbers(rows[i].size(), 4, at + "/volume_from_index/matrix/" + std::to_string(i), "give 4 x 4 numbers");
    }
    for (std::size_t i = 0; i < volume.steps.size(); ++i)
      must_exist(d.files, "files", volume.steps[i].picture, at + "/steps/" + std::to_string(i) + "/picture");
  }
  unique_ids(d.markers, place(d, "/markers"));
  for (std::size_t i = 0; i < d.markers.size(); ++i) {
    const Marker& marker = d.markers[i];
    const std::string at = place(d, "/markers/" + std::to_string(i));
    must_exist(d.volumes, "volumes", marker.volume, at + "/volume");
    needs_numbers(marker.centre_m.size(), 3, at + "/centre_m", "give a point [x, y, z]");
    needs_numbers(marker.covariance_m2.size(), 9, at + "/covariance_m2", "give 3 x 3 numbers, row by row");
    if (!marker.pixel.empty() && marker.pixel.size() != marker.seen_in.size())
      throw Error(Exit::data, at + "/pixel",
                  "has " + std::to_string(marker.pixel.size()) + " entries, seen_in has " +
                      std::to_string(marker.seen_in.size()),
                  "give [x, y] for each image");
  }
  for (std::size_t i = 0; i < d.placements.size(); ++i) {
    const Placement& placement = d.placements[i];
    const std::string at = place(d, "/placements/" + std::to_string(i));
    needs_numbers(placement.covariance.size(), 36, at + "/covariance", "give 6 x 6 numbers, row by row");
    needs_numbers(placement.centroid_m.size(), 3, at + "/centroid_m", "give a point [x, y, z]");
    for (std::size_t k = 0; k < placement.pairs.size(); ++k)
      needs_numbers(placement.pairs[k].world_m.size(), 3, at + "/pairs/" + std::to_string(k) + "/world_m",
                    "give a point [x, y, z]");
  }
}

void check_nrsfm(const Document& d) {
  for (const auto& [name, sequence] : d.sequences) {
    must_exist(d.files, "files", sequence.file, place(d, "/sequences/" + name + "/file"));
    must_exist(d.cameras, "cameras", sequence.camera, place(d, "/sequences/" + name + "/camera"));
  }
  unique_ids(d.reconstructions, place(d, "/reconstructions"));
  for (std::size_t i = 0; i < d.reconstructions.size(); ++i) {
    const ShapeReconstruction& r = d.reconstructions[i];
    const std::string at = place(d, "/reconstructions/" + std::to_string(i));
    must_exist(d.files, "files", r.file, at + "/file");
    must_exist(d.sequences, "sequences", r.sequence, at + "/sequence");
    if (r.file.empty() == r.folder.empty()) throw Error(Exit::data, at, "needs exactly one of \"file\", \"folder\"");
  }
}

void check_solid(const Document& d, const SolidBody& body, const std::string& at) {
  must_exist(d.files, "files", body.mesh, at + "/mesh");
  if (!body.box_m.empty() + body.ball_m.has_value() + !body.cylinder_m.empty() + !body.mesh.empty() != 1)
    throw Error(Exit::data, at, "needs exactly one of \"box_m\", \"ball_m\", \"cylinder_m\", \"mesh\"");
  needs_numbers(body.box_m.size(), 3, at + "/box_m", "give the full sides [x, y, z]");
  needs_numbers(body.cylinder_m.size(), 2, at + "/cylinder_m", "give [radius, length]");
}

void check_robots_of(const Document& d, const Laboratory& lab, const std::string& in) {
  for (const auto& [name, robot] : lab.robots) {
    const std::string at = in + "/robots/" + name;
    must_exist(d.files, "files", robot.urdf, at + "/urdf");
    must_exist(d.files, "files", robot.calibration, at + "/calibration");
    must_exist(d.files, "files", robot.registers, at + "/registers");
    needs_numbers(robot.payload_centre_m.size(), 3, at + "/payload_centre_m", "give a point [x, y, z]");
    for (std::size_t i = 0; i < robot.carries.size(); ++i)
      check_solid(d, robot.carries[i], at + "/carries/" + std::to_string(i));
    for (std::size_t i = 0; i < robot.links.size(); ++i)
      check_solid(d, robot.links[i], at + "/links/" + std::to_string(i));
  }
}

void check_laboratory(const Document& d) {
  for (const Laboratory& lab : d.laboratory.entry) {
    const std::string at = place(d, "/laboratory");
    check_robots_of(d, lab, at);
    for (const auto& [name, camera] : lab.cameras) {
      must_exist(lab.robots, "laboratory/robots", camera.robot, at + "/cameras/" + name + "/robot");
      needs_numbers(camera.exposure_s.size(), 2, at + "/cameras/" + name + "/exposure_s", "give [shortest, longest]");
    }
    for (const auto& [name, lamp] : lab.lamps) {
      const std::string where = at + "/lamps/" + name;
      must_exist(lab.robots, "laboratory/robots", lamp.robot, where + "/robot");
      must_exist(d.lights, "lights", lamp.light, where + "/light");
      needs_numbers(lamp.in_tool_m.size(), 3, where + "/in_tool_m", "give a point [x, y, z]");
      needs_numbers(lamp.in_world_m.size(), 3, where + "/in_world_m", "give a point [x, y, z]");
    }
    for (const auto& [name, table] : lab.turntables)
      needs_numbers(table.range_rad.size(), 2, at + "/turntables/" + name + "/range_rad", "give [smallest, largest]");
    for (std::size_t i = 0; i < lab.obstacles.size(); ++i)
      check_solid(d, lab.obstacles[i], at + "/obstacles/" + std::to_string(i));
    if (!lab.limits) continue;
    needs_numbers(lab.limits->lower_m.size(), 3, at + "/limits/lower_m", "give a point [x, y, z]");
    needs_numbers(lab.limits->upper_m.size(), 3, at + "/limits/upper_m", "give a point [x, y, z]");
  }
}

void check_plans(const Document& d) {
  unique_ids(d.plans, place(d, "/plans"));
  for (std::size_t i = 0; i < d.plans.size(); ++i)
    for (std::size_t k = 0; k < d.plans[i].steps.size(); ++k) {
      const PlanStep& step = d.plans[i].steps[k];
      const std::string at = place(d, "/plans/" + std::to_string(i) + "/steps/" + std::to_string(k));
      needs_numbers(step.light_m.size(), 3, at + "/light_m", "give a point [x, y, z]");
      for (const Laboratory& lab : d.laboratory.entry) {
        must_exist(lab.cameras, "laboratory/cameras", step.camera, at + "/camera");
        must_exist(lab.robots, "laboratory/robots", step.robot, at + "/robot");
        for (const auto& lamp : step.lamps) must_exist(lab.lamps, "laboratory/lamps", lamp, at + "/lamps");
      }
    }
  for (std::size_t i = 0; i < d.runs.size(); ++i)
    must_exist(d.files, "files", d.runs[i].journal, place(d, "/runs/" + std::to_string(i) + "/journal"));
}

void check_lights(const Document& d) {
  for (const auto& [name, around] : d.environments)
    must_exist(d.files, "files", around.file, place(d, "/environments/" + name + "/file"));
  for (const auto& [name, light] : d.lights) {
    const std::string at = place(d, "/lights/" + name);
    must_exist(d.files, "files", light.file, at + "/file");
    must_exist(d.environments, "environments", light.environment, at + "/environment");
    if (!light.file.empty() && !light.environment.empty())
      throw Error(Exit::data, at, "has both \"file\" and \"environment\"", "keep one of the two");
  }
}

void check_scans(const Document& d) {
  for (const auto& [name, projection] : d.projections)
    for (std::size_t i = 0; i < projection.frames.size(); ++i)
      must_exist(d.files, "files", projection.frames[i].file,
                 place(d, "/projections/" + name + "/frames/" + std::to_string(i) + "/file"));
  for (std::size_t i = 0; i < d.images.size(); ++i) {
    const ImageEntry& image = d.images[i];
    const std::string at = place(d, "/images/" + std::to_string(i));
    must_exist(d.projections, "projections", image.projection, at + "/projection");
    if (image.shows && image.projection.empty())
      throw Error(Exit::data, at + "/shows", "stands without a projection", "name the projection whose frame it shows");
    if (image.shows && static_cast<std::size_t>(*image.shows) >= d.projections.at(image.projection).frames.size())
      throw Error(Exit::data, at + "/shows",
                  "is " + std::to_string(*image.shows) + ", and the projection has " +
                      std::to_string(d.projections.at(image.projection).frames.size()) + " frames",
                  "count from 0");
  }
  for (const auto& [name, cloud] : d.clouds) {
    const std::string at = place(d, "/clouds/" + name);
    must_exist(d.files, "files", cloud.file, at + "/file");
    must_exist(d.projections, "projections", cloud.projection, at + "/projection");
    for (const std::string& camera : cloud.cameras) must_exist(d.cameras, "cameras", camera, at + "/cameras");
    if (cloud.shape) must_exist(d.meshes, "meshes", cloud.shape->mesh, at + "/shape/mesh");
  }
  for (const Registration& registration : d.registration.entry) {
    const std::string at = place(d, "/registration");
    must_exist(d.clouds, "clouds", registration.fixed, at + "/fixed");
    for (const RegisteredPair& pair : registration.pairs)
      for (const std::string& cloud : pair.clouds) must_exist(d.clouds, "clouds", cloud, at + "/pairs");
    for (const RegisteredView& view : registration.views) must_exist(d.clouds, "clouds", view.cloud, at + "/views");
  }
}

}  // namespace

void check_references(const Document& d) {
  check_images(d);
  check_goniometry(d);
  check_reliefs(d);
  check_prints(d);
  check_colour(d);
  check_volumes(d);
  check_laboratory(d);
  check_plans(d);
  check_nrsfm(d);
  check_scans(d);
  check_alignments(d);
  unique_ids(d.objects, place(d, "/objects"));
  for (std::size_t i = 0; i < d.objects.size(); ++i) {
    const std::string at = place(d, "/objects/" + std::to_string(i));
    must_exist(d.meshes, "meshes", d.objects[i].mesh, at + "/mesh");
    must_exist(d.surfaces, "surfaces", d.objects[i].surface, at + "/surface");
  }
  for (const auto& [name, mesh] : d.meshes) {
    const std::string at = place(d, "/meshes/" + name);
    must_exist(d.files, "files", mesh.file, at + "/file");
    for (std::size_t k = 0; k < mesh.shapes.size(); ++k)
      must_exist(d.files, "files", mesh.shapes[k], at + "/shapes/" + std::to_string(k));
    if (!mesh.shapes.empty() && mesh.file.empty())
      throw Error(Exit::data, at, "has \"shapes\" without a \"file\" whose vertices they are");
    if (!mesh.file.empty() + mesh.sphere_radius_m.has_value() + mesh.plane_size_m.has_value() != 1)
      throw Error(Exit::data, at, "needs exactly one of \"file\", \"sphere\", \"plane\"");
  }
  for (const auto& [name, surface] : d.surfaces) {
    const std::string at = place(d, "/surfaces/" + name);
    for (const auto& [parameter, file] : surface.textures)
      must_exist(d.files, "files", file, at + "/textures/" + parameter);
    for (const auto& [parameter, file] : surface.spectra)
      must_exist(d.files, "files", file, at + "/spectra/" + parameter);
    must_exist(d.files, "files", surface.file, at + "/file");
    must_exist(d.surfaces, "surfaces", surface.base, at + "/base");
  }
  check_lights(d);
  for (const auto& [name, table] : d.tables) {
    const std::string at = place(d, "/tables/" + name);
    must_exist(d.files, "files", table.file, at + "/file");
    must_exist(d.cameras, "cameras", table.camera, at + "/camera");
    must_exist(d.boards, "boards", table.board, at + "/board");
    check_table(table, at);
  }
  for (const auto& [name, rig] : d.rigs)
    for (std::size_t i = 0; i < rig.cameras.size(); ++i)
      must_exist(d.cameras, "cameras", rig.cameras[i].camera,
                 place(d, "/rigs/" + name + "/cameras/" + std::to_string(i) + "/camera"));
  for (const auto& [name, robot] : d.robots)
    must_exist(d.files, "files", robot.calibration, place(d, "/robots/" + name + "/calibration"));
  unique_ids(d.light_positions, place(d, "/light_positions"));
  for (std::size_t i = 0; i < d.renderings.size(); ++i)
    must_exist(d.files, "files", d.renderings[i].file, place(d, "/renderings/" + std::to_string(i) + "/file"));
}

}  // namespace gonio::manifest
