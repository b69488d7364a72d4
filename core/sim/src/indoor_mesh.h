#pragma once

#include "indoor_plan.h"
#include "mesh.h"

namespace hqslam::sim {

/// Walls with doors and windows, floors, stairs, and what stands in rooms and corridors.
TriangleMesh make_indoor_mesh(const IndoorPlan& plan);

/// Furniture of a room, clear of its middle and of the way to the door.
void furnish_room(TriangleMesh& mesh, const Room& room);

}  // namespace hqslam::sim
