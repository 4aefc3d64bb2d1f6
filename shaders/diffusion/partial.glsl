// One partial sum a subgroup, in a fixed order: dot products come out the same bit for bit on every run.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
layout(binding = 3, scalar) buffer Partials { float partials[]; };

void leave_partial(float value) {
  float sum = subgroupAdd(value);
  if (subgroupElect())
    partials[(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * DIFFUSION_PARTIALS + gl_SubgroupID] = sum;
}
