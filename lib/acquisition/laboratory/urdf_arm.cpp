// See urdf_arm.h.
#include "acquisition/laboratory/urdf_arm.h"

#include "acquisition/laboratory/solid_bodies.h"
#include "base/error.h"
#include "manifest/document.h"
#include "manifest/file_paths.h"

namespace gonio::acquisition {
namespace {

Solid solid_of_collision(const manifest::Document& document, const io::UrdfCollision& shape,
                         const std::filesystem::path& description) {
  Solid solid;
  solid.sides_m = shape.size_m;
  switch (shape.form) {
    case io::UrdfForm::box: break;
    case io::UrdfForm::cylinder: solid.shape = Solid::Shape::cylinder; break;
    case io::UrdfForm::sphere: solid.shape = Solid::Shape::ball; break;
    case io::UrdfForm::mesh: {
      const std::filesystem::path path = robot::mesh_of_urdf(shape.mesh, description);
      if (!document.allow_outside && !manifest::lies_within(path, document.folder))
        throw Error(Exit::data, description.filename().string(),
                    "names " + shape.mesh + " outside the manifest's folder",
                    "move it there, or allow it with --allow-outside");
      put_mesh(path, solid);
      for (Vec3& vertex : solid.vertices_m) vertex *= shape.scale;
      break;
    }
  }
  return solid;
}

}  // namespace

DescribedArm described_arm(const manifest::Document& document, const std::string& file_id, const std::string& pointer) {
  if (file_id.empty())
    throw Error(Exit::data, manifest::place(document, pointer), "has the model urdf and no file",
                "give its description as urdf");
  const std::filesystem::path description = manifest::resolve(document, file_id, pointer + "/urdf");
  DescribedArm arm;
  arm.kinematics = robot::arm_of_urdf(io::read_urdf(description), "", "", description.filename().string());
  for (const robot::CollisionBody& body : arm.kinematics.bodies) {
    Solid solid = solid_of_collision(document, body.shape, description);
    solid.name = body.link;
    solid.link = static_cast<int>(body.behind);
    solid.placed = {body.frame_from_body.rotation, body.frame_from_body.translation_m};
    arm.solids.push_back(std::move(solid));
  }
  return arm;
}

}  // namespace gonio::acquisition
