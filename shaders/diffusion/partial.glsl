// One partial sum a subgroup, in a fixed order: dot products come out the same bit for bit on every run.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
layout(binding = 3, scalar) buffer Partials { float partials[]; };

// Several sums of a pass lie one after the other.
void leave_partial(uint which, float value) {
  float sum = subgroupAdd(value);
  uint group = (which * gl_NumWorkGroups.y + gl_WorkGroupID.y) * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (subgroupElect()) partials[group * DIFFUSION_PARTIALS + gl_SubgroupID] = sum;
}

void leave_partial(float value) { leave_partial(0, value); }
