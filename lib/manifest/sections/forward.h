// Names of the manifest and of its sections, for headers and sources that pass them on. Who touches a section's fields
// includes that section's header, and no other: a new field then rebuilds its table and its users (a test counts them).
//
// Their field tables (lib/manifest/*_tables.cpp, one line a field: JSON name, member, unit, range, sentence) yield
// reading, validation, writing, schemas/*.schema.json and gonio-manifest(5). Frames: `world_from_camera` takes camera
// coordinates to world coordinates; camera axes x right, y down, z forward. Units stand in the names. Pixel centres lie
// at integers. gonio-conventions(7) has it in full.
#pragma once

namespace gonio::manifest {

struct Document;
struct ReadOptions;
struct Step;

struct AcceptanceResult;
struct AlternativeFit;
struct Board;
struct CableSlack;
struct Camera;
struct AlignedCamera;
struct AlignedLight;
struct Alignment;
struct AlignmentCandidate;
struct CameraQuality;
struct Cloud;
struct ColourAlternative;
struct ColourCorrection;
struct ColourPatch;
struct Comparison;
struct Contrast;
struct DetectedFlip;
struct DroppedRows;
struct EvaluatedError;
struct Environment;
struct Evaluation;
struct File;
struct FlatPatch;
struct GroundNoiseFit;
struct GroundNoisePart;
struct HeldOut;
struct ImageEntry;
struct IndexMap;
struct JointLimits;
struct Laboratory;
struct LaboratoryCamera;
struct LaboratoryLamp;
struct LaboratoryLimits;
struct LaboratoryRobot;
struct LaboratoryScreen;
struct LaboratoryTurntable;
struct LawUse;
struct Light;
struct LightPosition;
struct Link;
struct Marker;
struct Placement;
struct MechanismUse;
struct Mesh;
struct MicrostructureUse;
struct Mounting;
struct NormalsFit;
struct Object;
struct Outline;
struct Pattern;
struct PatternDefect;
struct PatternPlacement;
struct ProjectedFrame;
struct Projection;
struct Plan;
struct PlanStep;
struct Print;
struct PrintBleed;
struct PrintedPart;
struct PrintGrowth;
struct ReliefLobe;
struct ReliefMap;
struct ReliefTreatment;
struct RegisteredPair;
struct RegisteredView;
struct Registration;
struct Rendering;
struct Rig;
struct RigMember;
struct Robot;
struct RoughnessFigure;
struct Run;
struct ScatterParts;
struct SeenBoard;
struct ShapeReconstruction;
struct SolidBody;
struct Surface;
struct SurfaceFit;
struct Table;
struct TrackSequence;
struct UnreachableView;
struct Volume;
struct VolumeStep;

}  // namespace gonio::manifest
