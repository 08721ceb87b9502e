#include "scene/foreign.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#define PFC(name, key, value)                                                                      \
    { "PFC", name, key, value, "docs/tutorials/from-pfc.md" }
#define YADE(name, key, value)                                                                     \
    { "YADE", name, key, value, "docs/tutorials/from-yade.md" }
#define LAMMPS(name, key, value)                                                                   \
    { "LAMMPS", name, key, value, "docs/other-codes.md" }
#define LIGGGHTS(name, key, value)                                                                 \
    { "LIGGGHTS", name, key, value, "docs/other-codes.md" }
#define KRATOS(name, key, value)                                                                   \
    { "Kratos", name, key, value, "docs/other-codes.md" }

static const gn_foreign_name names[] = {
    PFC("kn", "materials[].normal_stiffness", "kn, with law.stiffness: uniform"),
    PFC("ks", "materials[].kratio", "kn/ks"),
    PFC("emod", "materials[].contact_modulus", "pi/4 emod"),
    PFC("fric", "materials[].friction", ""),
    PFC("pb_emod", "materials[].contact_modulus", "pi/4 pb_emod"),
    PFC("pb_kratio", "materials[].kratio", ""),
    PFC("pb_kn", "materials[].normal_stiffness", "A pb_kn, with law.stiffness: uniform"),
    PFC("pb_ks", "materials[].kratio", "pb_kn/pb_ks"),
    PFC("pb_ten", "materials[].tensile_strength", "pi/4 pb_ten"),
    PFC("pb_coh", "materials[].shear_strength", "pi/4 pb_coh"),
    PFC("pb_fa", "materials[].bond_friction", "pb_fa, with law.coupling: linear"),
    PFC("pb_rmul", "bonds.radius_multiplier", ""),
    PFC("pb_mcf", "bonds.moment_share", ""),
    PFC("cb_tenf", "materials[].bond_tension_limit", ""),
    PFC("cb_shearf", "materials[].bond_shear_limit", ""),
    PFC("linearpbond", "bonds", "{radius_multiplier: 1}"),
    PFC("linearcbond", "bonds", "{}"),
    PFC("softbond", "law.softening", "energy, strain or ratio"),
    PFC("rr_fric", "materials[].rolling_friction", ""),
    PFC("dp_nratio", "damping.contact.fraction", ""),
    PFC("damp", "damping.background.coefficient", "damp, with model: nonviscous_component"),
    PFC("model random", "run.seed", ""),
    PFC("model domain", "domain", "its corners"),
    PFC("model cycle", "time.end", "a time"),
    PFC("model solve", "time.stop.unbalanced", "a ratio, as ratio-average"),
    PFC("cycle", "time.end", "a time"),
    PFC("solve", "time.stop.unbalanced", "a ratio, as ratio-average"),
    PFC("ball generate", "specimen.packing", "of a shape; the defaults make one"),
    PFC("contact model", "law", "one law for all contacts"),
    PFC("cmat", "law", "one law for all contacts"),
    PFC("ratio-average", "time.stop.unbalanced", ""),
    PFC("wall servo", "walls[].servo", "a stress or a force"),
    PFC("ball fix", "sets[].motion", "velocities; 0 fixes"),
    PFC("clump template", "clumps.shapes", "spheres or a surface"),
    PFC("smoothjoint", "joints", "planes, discs or a network"),
    PFC("fracture generate", "joints", "discs or a network"),
    YADE("JCFpmMat", "materials", "a material, and bonds: {}"),
    YADE("FrictMat", "materials", "a material, without bonds"),
    YADE("tensileStrength", "materials[].tensile_strength", "pi/4 tensileStrength"),
    YADE("cohesion", "materials[].shear_strength", "pi/4 cohesion"),
    YADE("frictionAngle", "materials[].bond_friction",
         "its tangent, with law.coupling: linear; of FrictMat materials[].friction"),
    YADE("residualFrictionAngle", "materials[].friction", "its tangent"),
    YADE("interactionDetectionFactor", "bonds.interaction_range", "interactionDetectionFactor - 1"),
    YADE("aabbEnlargeFactor", "bonds.interaction_range", "aabbEnlargeFactor - 1"),
    YADE("MindlinPhys", "law.stiffness", "hertz"),
    YADE("NewtonIntegrator", "damping.background", "its damping, with model: nonviscous_component"),
    YADE("PWaveTimeStep", "time.step", "auto"),
    YADE("blockedDOFs", "sets[].motion", "velocities; 0 fixes"),
    YADE("TriaxialStressController", "walls[].servo", "a stress"),
    YADE("PeriTriaxController", "periodic", "stresses or rates of its sides"),
    YADE("randomDensePack", "specimen.packing", "of a shape; the defaults make one"),
    YADE("makeCloud", "specimen.packing", "of a shape; the defaults make one"),
    YADE("appendClumped", "clumps", "shapes and their places"),
    YADE("CapillaryPhys", "law.cohesion", "liquid"),
    YADE("VTKRecorder", "output.snapshots", "a number of snapshots"),
    LAMMPS("Kn", "materials[].normal_stiffness", "Kn of gran/hooke, with law.stiffness: uniform"),
    LAMMPS("Kt", "materials[].kratio", "Kn/Kt"),
    LAMMPS("xmu", "materials[].friction", ""),
    LAMMPS("gamma_n", "damping.contact.fraction", "gamma_n sqrt(m/Kn)/2, m the reduced mass"),
    LAMMPS("bpm/rotational", "bonds", "{radius_multiplier: 1}"),
    LAMMPS("fix gravity", "gravity", "its vector"),
    LAMMPS("fix wall/gran", "walls", "a point and a normal"),
    LAMMPS("fix freeze", "sets[].motion", "{vx: 0, vy: 0, vz: 0}"),
    LAMMPS("fix move", "sets[].motion", "velocities"),
    LAMMPS("fix pour", "sources", "a shape and a rate"),
    LAMMPS("fix deform", "periodic", "rates of its sides"),
    LAMMPS("thermo", "output.history_rows", "a number of rows"),
    LIGGGHTS("youngsModulus", "materials[].young", "youngsModulus, with law.stiffness: hertz"),
    LIGGGHTS("poissonsRatio", "materials[].poisson", ""),
    LIGGGHTS("coefficientRestitution", "materials[].restitution", ""),
    LIGGGHTS("coefficientFriction", "materials[].friction", ""),
    LIGGGHTS("coefficientRollingFriction", "materials[].rolling_friction", ""),
    LIGGGHTS("cohesionEnergyDensity", "law.cohesion", "jkr, with adhesion of the materials"),
    LIGGGHTS("mesh/surface", "bodies[].surface", "the STL file"),
    LIGGGHTS("insert/stream", "sources", "a shape and a rate"),
    LIGGGHTS("insert/pack", "specimen", "a shape with particles"),
    KRATOS("YOUNG_MODULUS", "materials[].young", "YOUNG_MODULUS, with law.stiffness: dempack"),
    KRATOS("POISSON_RATIO", "materials[].poisson", ""),
    KRATOS("PARTICLE_DENSITY", "materials[].density", ""),
    KRATOS("STATIC_FRICTION", "materials[].friction", "a single coefficient"),
    KRATOS("DYNAMIC_FRICTION", "materials[].friction", "a single coefficient"),
    KRATOS("ROLLING_FRICTION", "materials[].rolling_friction", ""),
    KRATOS("COEFFICIENT_OF_RESTITUTION", "damping.contact.restitution", ""),
    KRATOS("CONTACT_SIGMA_MIN", "materials[].tensile_strength", "CONTACT_SIGMA_MIN, in Pa"),
    KRATOS("CONTACT_TAU_ZERO", "materials[].shear_strength", "CONTACT_TAU_ZERO, in Pa"),
    KRATOS("CONTACT_INTERNAL_FRICC", "materials[].bond_friction", ""),
    KRATOS("MaxTimeStep", "time.step", "auto"),
    KRATOS("FinalTime", "time.end", ""),
};

enum { NAMES = sizeof names / sizeof *names };

const gn_foreign_name *gn_foreign_next(const char *name, const gn_foreign_name *after) {
    for (size_t k = after ? (size_t)(after - names) + 1 : 0; k < NAMES; k++)
        if (strcasecmp(names[k].name, name) == 0) return &names[k];
    return NULL;
}

void gn_foreign_describe(const gn_foreign_name *entry, char *text, size_t size) {
    snprintf(text, size, "%s of %s is %s%s%s (%s)", entry->name, entry->program, entry->key,
             *entry->value ? ": " : "", entry->value, entry->page);
}
