"""The keys of scene files as dicts that an editor completes and mypy checks. Written by python/make_keys.py; do not edit.

    scene = gneiss.keys.Scene(materials=[gneiss.keys.Material(name="rock", density="2600 kg/m3")], ...)

Each is an ordinary dict at run time, as gneiss.Scene takes it. docs/keys.md has the same list.
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, TypedDict, Union

Number = Union[float, str]  # in SI, or a text with a unit
Vector = Sequence[Number]
Rows = Any  # rows of numbers, also as an array of numpy, or their number
Table = Union[float, str, Sequence[Sequence[Number]]]  # constant, [[time, value], ...], or a formula of t in a text
Tables = Sequence[Table]


class Scene(TypedDict, total=False):
    title: str  # text: one line for reports
    dimension: int | str  # whole number, in [2, 3]: 2: discs in plane strain; 3: spheres (default 3)
    origin: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: origin of the coordinates of the computation; left out: near the model if that lies far from 0, else 0
    specimen: Specimen  # the particles at the start; specimen, sources, elements or several of them
    materials: Sequence[Material]  # materials of particles; needed with a specimen
    contacts: Sequence[Contact]  # values of contacts between two materials (or one with itself) that replace those from the materials
    law: Law  # the contact law; needed with a specimen
    elements: Elements  # finite elements: linear triangles in plane strain or tetrahedra
    couple: Couple  # coupling of particles and elements in zones that both share
    bonds: Bonds  # brittle bonds between particles of one group
    damping: Damping  # dissipation in addition to friction and breakage
    gravity: Tables  # [x, y, z], in 2D [x, y], of numbers, formulas of t or tables, m/s2, in [-1e12, 1e12]: acceleration of free fall (default 0)
    initial: Initial  # the state at the start
    periodic: Periodic  # a periodic box
    domain: Domain  # region of space that particles must not leave
    sets: Sequence[Set]  # selections of particles and actions on them; a later one overrides an earlier one
    walls: Sequence[Wall]  # plane walls
    bodies: Sequence[Body]  # rigid bodies with a surface of triangles (2D: segments)
    joints: Sequence[Joint]  # joints in the specimen; contacts that cross one follow the law of the joint
    sources: Sequence[Source]  # regions where particles are created during the run
    sinks: Sequence[Sink]  # regions where particles are removed and counted; each sink takes those that earlier ones leave
    clumps: Clumps  # rigid clumps of particles that may overlap within one
    membrane: Membrane  # pressure on the surface of the specimen
    test: Test  # a laboratory test, for which stress and strain are read
    time: Time  # step and duration
    stages: Sequence[Stage]  # consecutive stages of the run; left out: one stage
    output: Output  # files that a run writes
    neighbours: Neighbours  # the neighbour list
    run: Run  # execution of the run; no physics


_Specimen = TypedDict('_Specimen', {'from': 'str'}, total=False)

class Specimen(_Specimen, total=False):
    file: str  # file: text file of rows x y z r (2D: x y r), or of columns that its header names (id, material, group, density, velocities; units); relative to the folder of the scene
    from_velocities: Literal['rest', 'keep']  # velocities of particles from another run: kept, or zero (default keep)
    from_bonds: Literal['none', 'keep']  # keep: intact bonds of the other run are taken over with their stress-free lengths; none: bonds form by the section bonds (default none)
    scale: Number  # number, in [1e-12, 1e12]: lengths in the file, surface or mesh times this give metres (default 1)
    particles: Rows  # list of rows, m, or a whole number in [4, 1e8]: rows [x, y, z, r] of particles, in 2D [x, y, r]; or the number of particles to pack into a shape
    lattice: SpecimenLattice  # a regular arrangement of equal particles
    rectangle: SpecimenRectangle  # 2D shape; its lower left corner is at the origin
    disc: SpecimenDisc  # 2D shape; its centre is at the origin
    polygon: Rows  # list of at least 3 points [x, y], m, in [-1e9, 1e9]: 2D shape: its corners in either sense of rotation
    box: SpecimenBox  # 3D shape; its lower corner is at the origin
    cylinder: SpecimenCylinder  # 3D shape, axis along z; the centre of its lower end is at the origin
    surface: str  # file: 3D shape: STL, PLY or OBJ file of a closed surface
    mesh: str  # file: 2D or 3D shape: gmsh .msh file, whose triangles (3D: tetrahedra) are the body; or a .geo, .step, .brep or .iges file, which the gmsh program meshes first: only with --allow-gmsh, as such a file can execute commands
    origin: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: position of the origin of a rectangle, disc, box or cylinder (default 0)
    mean_radius: Number  # number, m, in [1e-9, 1e9], or none: mean radius of the particles to pack into a shape, instead of their number (default none)
    packing: SpecimenPacking  # settings of the packing of a shape
    material: str  # text: name of the material; may be left out when there is only one
    group: int | str  # whole number, in [0, 1000000]: cohesive group: bonds form between particles of the same group; 0: never bonded (default 1)
    density_basis: Literal['particle', 'bulk']  # bulk: the material's density is that of the assembly, including voids (default particle)
    porosity: Number  # number, in [0, 1), or measure: with density_basis bulk: particle density is density/(1 - porosity) (default measure)


class SpecimenLattice(TypedDict, total=False):
    kind: Literal['square', 'hexagonal', 'cubic', 'fcc', 'hcp']  # square and hexagonal in 2D; cubic, fcc and hcp in 3D
    radius: Number  # number, m, in [1e-9, 1e9]: radius of every particle
    cells: Vector  # [x, y, z], in 2D [x, y], in [1, 100000]: unit cells along x, y and z
    origin: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: lower corner of the first cell (default 0)
    spacing: Number  # number, in [1e-3, 1e6]: distance of nearest neighbours over two radii; 1: just touching (default 1)
    jitter: Number  # number, in [0, 1): random shift of each centre along each axis, up to this times the radius (default 0)


class SpecimenRectangle(TypedDict, total=False):
    width: Number  # number, m, in [1e-9, 1e9]: length along x
    height: Number  # number, m, in [1e-9, 1e9]: length along y


class SpecimenDisc(TypedDict, total=False):
    diameter: Number  # number, m, in [1e-9, 1e9]: diameter of the disc


class SpecimenBox(TypedDict, total=False):
    size: Vector  # [x, y, z], m, in [1e-9, 1e9]: lengths along x, y and z


class SpecimenCylinder(TypedDict, total=False):
    diameter: Number  # number, m, in [1e-9, 1e9]: diameter of the cylinder
    height: Number  # number, m, in [1e-9, 1e9]: length along z


class SpecimenPacking(TypedDict, total=False):
    region: SpecimenPackingRegion  # packs only the part of the body, a rectangle or box, that is in this box; volume and porosity are those of the part
    size_ratio: Number  # number, in [1.2, 100]: requested largest over smallest radius; a sieve curve implies its own (default 6)
    size_variation: Number  # number, in [0, 1], or auto: standard deviation of the radii over their mean before the fit; with sizes fitted or normal (default auto)
    sizes: Literal['fitted', 'uniform', 'normal', 'sieve']  # distribution of the radii; fitted: the one that packs best. uniform and normal: by number, from the smallest to size_ratio times that; sieve: by the curve. The fit then changes each radius by at most a tenth, and packs less densely (default fitted)
    sieve: Rows  # list of at least 2 points [x, y], in [0, 1]: with sizes sieve: rows [size over the largest, mass fraction that passes], from [smallest, 0] to [1, 1]
    overlap: Literal['none', 'passive']  # passive: neighbours overlap by a few per cent, free of stress when bonded with bonds.passive_gaps (default none)
    overlap_size: Number  # number, in [0, 0.2], or auto: target overlap over the sum of the radii; with overlap passive (default auto)
    gap: Number  # number, in [0, 0.5], or auto: pairs up to this gap over the sum of the radii are closed (default auto)
    start: Literal['random', 'nodes']  # centres at the start: well-spread random points, or the inner nodes of the mesh (default random)
    jiggle: Number  # number, in [0, 1]: with start: nodes: random shift of the nodes over their spacing (default 0.3)
    refine: Sequence[SpecimenPackingRefine]  # regions with smaller particles
    iterations: int | str  # whole number, in [1, 1e6], or auto: largest number of iterations of the fit (default auto)
    residual: Number  # number, in (0, 1), or auto: the fit stops once the root mean square gap of the closed pairs, over the sum of their radii, is below this (default auto)
    time: Number  # number, s, in (0, inf), or off: wall time after which the best packing so far is taken; the result then depends on the machine (default off)


class SpecimenPackingRegion(TypedDict, total=False):
    min: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: lower corner
    max: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: upper corner


_SpecimenPackingRefine = TypedDict('_SpecimenPackingRefine', {'from': 'Vector'}, total=False)

class SpecimenPackingRefine(_SpecimenPackingRefine, total=False):
    to: Vector  # [x, y, z], in 2D [x, y], m: upper corner; given together with from
    boundary: Literal['true', 'false'] | bool  # refines at the boundary of the body instead of a box (default false)
    size: Number  # number, in [1e-3, 1]: size of the particles there over that elsewhere
    distance: Number  # number, m, in [1e-9, 1e9]: distance over which the size grows back


class Material(TypedDict, total=False):
    name: str  # name: name by which the rest of the scene refers to it
    density: Number  # number, kg/m3, in [1e-9, 1e15]: mass density, of particles or of the bulk (specimen.density_basis)
    contact_modulus: Number  # number, Pa, in [1e-9, 1e18], or none: E_c: normal stiffness over radius; needed by every law but uniform, hertz and those by area (default none)
    normal_stiffness: Number  # number, N/m, in [1e-15, 1e21], or none: k_n of every contact; needed by the uniform law (default none)
    kratio: Number  # number, in [0, 1e12], or none: k_n/k_t; 0: no tangential spring; needed by every law but those by area and hertz (default none)
    young: Number  # number, Pa, in [1e-9, 1e18], or none: E: k_n = alpha E A/L; needed by laws by area and hertz (default none)
    poisson: Number  # number, in (-1, 0.5], or none: nu: k_t = beta G A/L with G = E/(2 (1 + nu)); needed by laws by area and hertz (default none)
    alpha: Number  # number, in [1e-6, 1e6]: factor of E in k_n; laws by area (default 1)
    beta: Number  # number, in [0, 1e6]: factor of G in k_t; 0: no tangential spring; laws by area (default 1)
    friction: Number  # number, or an angle, in [0, 1e30]: Coulomb friction coefficient (default 0)
    rolling_friction: Number  # number, in [0, 1e30]: mu_r: contacts resist rolling up to the moment mu_r R |f_n|, R the reduced radius; 0: no resistance (default 0)
    twisting_friction: Number  # number, in [0, 1e30]: mu_t: contacts resist twisting up to the moment mu_t R |f_n|, R the reduced radius; 0: no resistance (default 0)
    adhesion: Number  # number, J/m2, in [0, 1e6]: with law.cohesion jkr and dmt: work of adhesion w of two surfaces of this material, twice its surface energy; of two materials the geometric mean (default 0)
    restitution: Number  # number, in [0, 1], or none: with hertz: restitution coefficient of its contacts, the smaller one of two materials; none: that of damping.contact (default none)
    tensile_strength: Number  # number, Pa, in [1e-12, 1e100], or none: sigma_c of a bond; needed with bonds by every law but uniform (default none)
    shear_strength: Number  # number, Pa, in [1e-12, 1e100], or none: tau_c of a bond; needed with bonds by every law but uniform (default none)
    bond_tension_limit: Number  # number, N, in [1e-30, 1e100], or none: R_n: normal force at which a bond breaks; needed with bonds by the uniform law (default none)
    bond_shear_limit: Number  # number, N, in [1e-30, 1e100], or none: R_t: shear force at which a bond breaks; needed with bonds by the uniform law (default none)
    strength_scatter: MaterialStrengthScatter  # random factor of mean 1, drawn for each bond, of its strengths in tension and shear
    stiffness_scatter: MaterialStiffnessScatter  # random factor of mean 1, drawn for each bond, of its normal and tangential stiffness
    bond_friction: Number  # number, or an angle, in [0, 1e30]: mu_1: a bond under compression |f_n| has its shear strength raised by mu_1 |f_n|; once broken it has friction instead (default 0)
    fracture_energy: Number  # number, J/m2, in [1e-30, 1e100], or none: G_f in tension, per area of a bond; needed with softening energy (default none)
    shear_fracture_energy: Number  # number, J/m2, in [1e-30, 1e100], or auto, or none: G_f in shear without pressure, per area of a bond; auto: bonds soften over the same multiple of the elastic limit as in tension; none: brittle in shear (default auto)
    fracture_strain: Number  # number, in [1e-30, 1e100], or none: eps_f: elongation of a bond over its length at the end of softening; needed with softening strain (default none)
    shear_fracture_strain: Number  # number, in [1e-30, 1e100], or none: slip of a bond over the root of its area at the end of softening in shear; none: brittle in shear (default none)
    fracture_ratio: Number  # number, in [1e-30, 1e100], or none: softening ends at 1 + this times the elastic limit, in tension and in shear; needed with softening ratio (default none)
    yield_stress_1: Number  # number, Pa, in [1e-12, 1e100], or none: compressive stress of a bond above which its loading stiffness is k_n/yield_ratio_1; it unloads with k_n (default none)
    yield_ratio_1: Number  # number, in [1, 1e9], or none: k_n over the loading stiffness above yield_stress_1; needed with it (default none)
    yield_stress_2: Number  # number, Pa, in [1e-12, 1e100], or none: compressive stress of a bond, above yield_stress_1, above which its loading stiffness is k_n/yield_ratio_2 (default none)
    yield_ratio_2: Number  # number, in [1, 1e9], or none: k_n over the loading stiffness above yield_stress_2; needed with it (default none)
    yield_stress_3: Number  # number, Pa, in [1e-12, 1e100], or none: compressive stress of a bond, above yield_stress_2, above which its loading stiffness is k_n/yield_ratio_3 (default none)
    yield_ratio_3: Number  # number, in [1, 1e9], or none: k_n over the loading stiffness above yield_stress_3; needed with it (default none)


class MaterialStrengthScatter(TypedDict, total=False):
    distribution: Literal['weibull', 'normal']  # distribution of the factor of a bond
    modulus: Number  # number, in [0.5, 1e4], or none: Weibull modulus; needed by weibull (default none)
    deviation: Number  # number, in [1e-6, 0.33], or none: standard deviation over the mean; needed by normal, which is truncated at 0 and 2 (default none)


class MaterialStiffnessScatter(TypedDict, total=False):
    distribution: Literal['weibull', 'normal']  # distribution of the factor of a bond
    modulus: Number  # number, in [0.5, 1e4], or none: Weibull modulus; needed by weibull (default none)
    deviation: Number  # number, in [1e-6, 0.33], or none: standard deviation over the mean; needed by normal, which is truncated at 0 and 2 (default none)


class Contact(TypedDict, total=False):
    between: str | Sequence[str]  # name or list of names: the two materials, in either order; one name: that material with itself
    friction: Number  # number, or an angle, in [0, 1e30], or combined: friction coefficient, instead of the smaller (default combined)
    kratio: Number  # number, in [0, 1e12], or combined: k_n/k_t; 0: no tangential spring (default combined)
    contact_modulus: Number  # number, Pa, in [1e-9, 1e18], or combined: E_c, instead of both in series (default combined)
    normal_stiffness: Number  # number, N/m, in [1e-15, 1e21], or combined: k_n, instead of both in series (default combined)
    young: Number  # number, Pa, in [1e-9, 1e18], or combined: E of laws by area and hertz, instead of both in series (default combined)
    poisson: Number  # number, in (-1, 0.5], or combined: nu of laws by area and hertz, instead of the values of both materials (default combined)
    alpha: Number  # number, in [1e-6, 1e6], or combined: factor in laws by area, instead of the harmonic mean (default combined)
    beta: Number  # number, in [0, 1e6], or combined: factor in laws by area, instead of the harmonic mean (default combined)
    tensile_strength: Number  # number, Pa, in [1e-12, 1e100], or combined: sigma_c of a bond, instead of the smaller (default combined)
    shear_strength: Number  # number, Pa, in [1e-12, 1e100], or combined: tau_c of a bond, instead of the smaller (default combined)
    bond_tension_limit: Number  # number, N, in [1e-30, 1e100], or combined: R_n of the uniform law, instead of the smaller (default combined)
    bond_shear_limit: Number  # number, N, in [1e-30, 1e100], or combined: R_t of the uniform law, instead of the smaller (default combined)
    bond_friction: Number  # number, or an angle, in [0, 1e30], or combined: mu_1 of a bond, instead of the smaller (default combined)
    adhesion: Number  # number, J/m2, in [0, 1e6], or combined: w, instead of the geometric mean (default combined)
    rolling_friction: Number  # number, in [0, 1e30], or combined: mu_r, instead of the smaller (default combined)
    twisting_friction: Number  # number, in [0, 1e30], or combined: mu_t, instead of the smaller (default combined)
    restitution: Number  # number, in [0, 1], or combined: restitution coefficient with hertz, instead of the smaller (default combined)
    fracture_energy: Number  # number, J/m2, in [1e-30, 1e100], or combined: G_f of a bond in tension, with softening energy, instead of the smaller (default combined)
    shear_fracture_energy: Number  # number, J/m2, in [1e-30, 1e100], or combined: G_f of a bond in shear, with softening energy, instead of the smaller (default combined)


class Law(TypedDict, total=False):
    stiffness: Literal['uniform', 'arithmetic', 'harmonic', 'mean_radius', 'mean_arithmetic', 'mean_harmonic', 'dempack', 'polyhedron', 'hertz']  # stiffness and bond strength from the radii (Rojek et al. 2012, sec. 2), or from E, nu and sections of the bonds (dempack, polyhedron: Santasusana 2013); hertz: unbonded spheres, by Hertz and Mindlin from E and nu
    gamma: Number  # number, in [1e-6, 1e6], or auto: section of a bond over Dempack's pi (2 r_i r_j/(r_i + r_j))^2 (2D: 4 r_i r_j/(r_i + r_j) times 1 m); with polyhedron, of pairs that come into contact later (default auto)
    gamma_rule: Literal['volume', 'porosity']  # rule for gamma: auto; volume: the sum of sections times lengths equals the dimension times the volume; porosity: 40 e/n_c (Santasusana 2013) (default volume)
    contact_arm: Literal['midpoint', 'radius']  # contact point: midpoint of the gap, or one radius from the centre (default midpoint)
    pull: Literal['true', 'false'] | bool  # with hertz: the dashpot may exert tension at the end of a collision; false: the total force is cut off at zero, and the dashpot is adjusted to keep the restitution (default true)
    cohesion: Literal['none', 'jkr', 'dmt', 'liquid']  # with hertz: attraction of particles; jkr: Johnson, Kendall and Roberts 1971, with necks; dmt: constant pull-off force while they touch; liquid: bridges of liquid (Willett et al. 2000) (default none)
    surface_tension: Number  # number, N/m, in (0, 100], or none: surface tension of the liquid; needed by cohesion liquid (default none)
    contact_angle: Number  # number, rad, in [0, 0.8726646259971648]: angle of the liquid on the particles, with cohesion liquid; at most 50 degrees, the range of the fit (default 0)
    liquid_content: Number  # number, in (0, 0.5], or none: volume of the liquid over that of the particles at the start; needed by cohesion liquid (default none)
    rotation: Literal['auto', 'on', 'off'] | bool  # particles rotate; auto: on (default auto)
    coupling: Literal['none', 'quadratic', 'linear']  # reduction of a bond's shear strength by tension; quadratic: the bond breaks when the squares of force over strength add up to 1; linear: by mu_1 f_n (default none)
    confinement: Literal['own', 'mean']  # normal force that the friction of bonds (bond_friction) acts on: own: that of the bond; mean: that of the mean stress around its two particles (default own)
    softening: Literal['none', 'energy', 'strain', 'ratio']  # behaviour of bonds beyond their strength: none: they break at once; else they soften up to the fracture energy, strain or ratio of the material (default none)
    softening_curve: Literal['linear', 'bilinear']  # with softening energy: linear, or bilinear: steep first, then flat, as for concrete (default linear)
    kink_stress: Number  # number, in [0.01, 0.99]: bilinear: fraction of the strength at the kink; Petersson: a third (default 0.3333333333333333)
    initial_energy: Number  # number, in [0.01, 0.99]: bilinear: fraction of the fracture energy under the first line, extended to zero; Petersson: 0.6 (default 0.6)
    fracture_energy_of: Literal['contact', 'body']  # area that fracture energies refer to: contact: that of a bond; body: that of a plane through the specimen, whose bonds have a larger total area (default contact)


class Elements(TypedDict, total=False):
    mesh: str  # file: gmsh .msh file of triangles (3D: tetrahedra); quadrangles, hexahedra, prisms and pyramids are split, and of elements of higher order the corners are used
    scale: Number  # number, in [1e-12, 1e12]: lengths in the file times this give metres (default 1)
    rectangle: ElementsRectangle  # built-in 2D mesh; groups body, x_lower, x_upper, ...
    box: ElementsBox  # built-in 3D mesh; groups body, x_lower, x_upper, y_lower, ...
    beam: ElementsBeam  # built-in mesh of a beam for bending, with an optional notch; groups also support_left, support_right, supports, load, notch, mouth_left, mouth_right
    formulation: Literal['displacement', 'mixed']  # displacement, or mixed displacement and pressure for nearly incompressible materials (default displacement)
    materials: Sequence[ElementsMaterial]  # materials of elements; a later one overrides an earlier one
    motions: Sequence[ElementsMotion]  # nodes that move as prescribed, or are only observed; a later one overrides an earlier one
    loads: Sequence[ElementsLoad]  # tractions and forces, which add up
    contact: ElementsContact  # contact of particles with the surface; without it they pass through


class ElementsRectangle(TypedDict, total=False):
    size: Vector  # [x, y, z], in 2D [x, y], m: lengths along the axes
    cells: Vector  # [x, y, z], in 2D [x, y], in [1, 1e6]: cells along the axes, of two triangles or five (parallel: six) tetrahedra each
    origin: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: lower corner (default 0)
    distortion: Number  # number, in [0, 0.25): random shift of the nodes over the sides of a cell; in 3D below 1/6 (default 0)
    diagonals: Literal['alternating', 'parallel']  # diagonals of the cells: alternating prefers no direction; parallel gives equal masses to all inner nodes of equal cells, for waves only some elements long and for coupling zones (default alternating)


class ElementsBox(TypedDict, total=False):
    size: Vector  # [x, y, z], in 2D [x, y], m: lengths along the axes
    cells: Vector  # [x, y, z], in 2D [x, y], in [1, 1e6]: cells along the axes, of two triangles or five (parallel: six) tetrahedra each
    origin: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: lower corner (default 0)
    distortion: Number  # number, in [0, 0.25): random shift of the nodes over the sides of a cell; in 3D below 1/6 (default 0)
    diagonals: Literal['alternating', 'parallel']  # diagonals of the cells: alternating prefers no direction; parallel gives equal masses to all inner nodes of equal cells, for waves only some elements long and for coupling zones (default alternating)


class ElementsBeam(TypedDict, total=False):
    length: Number  # number, m, in [1e-9, 1e9]: length along x
    height: Number  # number, m, in [1e-9, 1e9]: height, along y
    thickness: Number  # number, m, in [1e-9, 1e9], or none: thickness, along z; needed in 3D (default none)
    span: Number  # number, m, in [1e-9, 1e9], or auto: distance of the supports; auto: the length (default auto)
    notch_depth: Number  # number, m, in [1e-9, 1e9], or none: depth of the notch in the lower side at mid-span (default none)
    notch_width: Number  # number, m, in [1e-9, 1e9], or none: width of the notch; needed with notch_depth (default none)
    cell: Number  # number, m, in [1e-9, 1e9]: largest side of a cell
    notch_cells: int | str  # whole number, in [1, 1000]: cells over half the width of the notch; they set the size of the cells at its tip (default 1)
    growth: Number  # number, in [1.01, 3]: ratio of neighbouring cells away from the notch (default 1.2)
    origin: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: lower corner (default 0)
    diagonals: Literal['alternating', 'parallel']  # as for a rectangle or box; parallel ones are mirrored at mid-span (default alternating)


class ElementsMaterial(TypedDict, total=False):
    group: str  # text: group of elements in the mesh, by name or number; left out: all elements
    young: Number  # number, Pa, in [1e-9, 1e18]: Young's modulus
    poisson: Number  # number, in (-1, 0.5]: Poisson's ratio, below 0.5: an incompressible material has no stable step in an explicit scheme
    density: Number  # number, kg/m3, in [1e-9, 1e15]: mass density


class ElementsMotion(TypedDict, total=False):
    name: str  # name: name by which the rest of the scene and the columns of the history refer to it
    group: str  # text: nodes of a group of the mesh, by name or number
    box: ElementsMotionBox  # nodes that start in a box, boundary included; instead of group
    motion: ElementsMotionMotion  # each component free, constant or a table [[time, value], ...]; all free: only the displacement is recorded


class ElementsMotionBox(TypedDict, total=False):
    min: Vector  # [x, y, z], in 2D [x, y], m: lower corner
    max: Vector  # [x, y, z], in 2D [x, y], m: upper corner


class ElementsMotionMotion(TypedDict, total=False):
    vx: Table  # number, formula of t or table [[time, value], ...], m/s, in [-3e8, 3e8], or free: prescribed velocity along x (default free)
    vy: Table  # number, formula of t or table [[time, value], ...], m/s, in [-3e8, 3e8], or free: prescribed velocity along y (default free)
    vz: Table  # number, formula of t or table [[time, value], ...], m/s, in [-3e8, 3e8], or free: prescribed velocity along z (default free)


class ElementsLoad(TypedDict, total=False):
    name: str  # text: name for --set; may be left out
    group: str  # text: nodes or facets of a group of the mesh, by name or number
    box: ElementsLoadBox  # nodes that start in a box, or facets of the mesh that lie entirely in it; instead of group
    traction: ElementsLoadTraction  # force per area on facets, of fixed direction; each component constant or a table
    force: ElementsLoadForce  # total force, distributed by area over the facets of a group of facets, otherwise by mass; each component constant or a table


class ElementsLoadBox(TypedDict, total=False):
    min: Vector  # [x, y, z], in 2D [x, y], m: lower corner
    max: Vector  # [x, y, z], in 2D [x, y], m: upper corner


class ElementsLoadTraction(TypedDict, total=False):
    tx: Table  # number, formula of t or table [[time, value], ...], Pa, in [-1e18, 1e18], or none: component along x (default none)
    ty: Table  # number, formula of t or table [[time, value], ...], Pa, in [-1e18, 1e18], or none: component along y (default none)
    tz: Table  # number, formula of t or table [[time, value], ...], Pa, in [-1e18, 1e18], or none: component along z (default none)


class ElementsLoadForce(TypedDict, total=False):
    fx: Table  # number, formula of t or table [[time, value], ...], N, in [-1e18, 1e18], or none: component along x (default none)
    fy: Table  # number, formula of t or table [[time, value], ...], N, in [-1e18, 1e18], or none: component along y (default none)
    fz: Table  # number, formula of t or table [[time, value], ...], N, in [-1e18, 1e18], or none: component along z (default none)


class ElementsContact(TypedDict, total=False):
    group: str  # text: facets of a group of the mesh, by name or number; left out: the whole boundary
    stiffness: Number  # number, N/m, in [1e-15, 1e21], or none: penalty stiffness k_n; needed by every law but hertz (default none)
    material: str  # text: with hertz: name of the material; left out: rigid, with its own friction and the restitution of the particles
    kratio: Number  # number, in [1e-6, 1e12], or none: k_n/k_t of the surface; needed with friction (default none)
    friction: Number  # number, or an angle, in [0, 1e30]: Coulomb friction coefficient (default 0)


class Couple(TypedDict, total=False):
    zones: Sequence[CoupleZone]  # zones in which particles and elements overlap; at least one without convert
    convert: CoupleConvert  # starts with elements everywhere, which turn into particles where stresses are high
    constraint: Literal['lumped', 'consistent', 'penalty']  # particles of a zone follow the nodes, which take their mass lumped or consistently; or springs connect both (default lumped)
    spins: Literal['free', 'slaved']  # spins of particles of a zone: free, or half the curl of the nodes' velocity (default free)
    penalty: Number  # number, in [1e-3, 1e3]: stiffness of the springs over its automatic value, from the stiffest particles and their masses (default 1)
    penalty_damping: Number  # number, in [0, 1]: dashpots in parallel with the springs, as a fraction of critical damping (default 0)


class CoupleZone(TypedDict, total=False):
    edges: Sequence[CoupleZoneEdge]  # one edge, or one for each side of particles that elements surround; particles that surround elements need a zone for each side


_CoupleZoneEdge = TypedDict('_CoupleZoneEdge', {'from': 'Vector'}, total=False)

class CoupleZoneEdge(_CoupleZoneEdge, total=False):
    to: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: the opposite point on the plane where the particles end, through their outermost centres


class CoupleConvert(TypedDict, total=False):
    box: CoupleConvertBox  # elements whose nodes all start in this box, boundary included, can convert; default: specimen.packing.region
    width: Number  # number, m, in [1e-9, 1e9]: width of the zone between particles and elements: at least three elements and six particles
    stress: Number  # number, Pa, in [1e-12, 1e100], or none: largest principal stress, tension positive, at which an element converts (default none)
    mohr_coulomb: CoupleConvertMohrCoulomb  # converts elements under compression: limit of (s1 - s3)/2 + (s1 + s3)/2 sin(phi) over cohesion cos(phi)
    bodies: Number  # number, m, in [1e-9, 1e9], or none: distance from a body at which elements convert, so that it touches particles alone; needed beside bodies: they have no contact with elements (default none)
    by: Literal['elements', 'nodes']  # stresses that are compared with the limits: of each element, or averaged from its nodes (default elements)
    every: int | str  # whole number, in [1, 1000000]: steps between two evaluations of the limits (default 50)
    most: Number  # number, in (0, 1]: largest fraction of the convertible elements that one evaluation converts, those with the highest stresses first; thin remnants are added to it (default 10 %)
    relax: Number  # number, in [1e-8, 1], or none: relaxation tolerance of newly released particles: they are equilibrated, with all others fixed, to a residual of this fraction of the mean contact force (default 1e-3)
    relax_iterations: int | str  # whole number, in [1, 1000000]: largest number of iterations of relax (default 1000)


class CoupleConvertBox(TypedDict, total=False):
    min: Vector  # [x, y, z], in 2D [x, y], m: lower corner
    max: Vector  # [x, y, z], in 2D [x, y], m: upper corner


class CoupleConvertMohrCoulomb(TypedDict, total=False):
    cohesion: Number  # number, Pa, in [1e-12, 1e100]: shear strength of a plane without pressure
    friction: Number  # number, or an angle, in [0, 100]: tan(phi), or the angle phi: increase of the shear strength over the pressure (default 0)


class Bonds(TypedDict, total=False):
    enabled: Literal['auto', 'on', 'off'] | bool  # auto: on when the scene has a bonds section (default auto)
    interaction_range: Number  # number, in [0, 100]: bonds form at gaps up to this times the sum of the radii (default 0.05)
    overlap_range: Number  # number, in [0, 1]: bonds form at overlaps up to this times the sum of the radii; 1: unlimited (but centres of bonded particles are at least 0.01 of the smaller radius apart) (default 1)
    passive_gaps: Literal['true', 'false'] | bool  # bonds are free of stress at the distance at which they form, and so are initial overlaps of particles without bonds (default true)
    radius_multiplier: Number  # number, in [0, 100]: bonds carry bending and twisting moments as beams (PFC's parallel bonds, pb_rmul) of this times the smaller radius of the two particles; 0: no moments (default 0)
    moment_share: Number  # number, in [0, 1]: share of moments in the strength of bonds with radius_multiplier (PFC's moment contribution, pb_mcf) (default 1)


class Damping(TypedDict, total=False):
    background: DampingBackground  # damping of the motion of every particle
    contact: DampingContact  # normal viscous damping in contacts


class DampingBackground(TypedDict, total=False):
    model: Literal['none', 'viscous', 'nonviscous_vector', 'nonviscous_component']  # viscous: -a m v; nonviscous_vector: -a |F| v/|v|; nonviscous_component: -a |F_k| sign(v_k) (default none)
    coefficient: Number  # number, 1/s or 1, in [0, 1e15]: a: in 1/s with viscous, otherwise a fraction in [0, 1) (default 0)
    rotation: Number  # number, 1/s or 1, in [0, 1e15], or same: a for spins, with -a I w and moments in place of forces; same: the value of coefficient (Labra 2012, eq. 2.38-2.41, has a separate one) (default same)
    velocity: Literal['half_step', 'instant']  # with nonviscous_component: velocity whose sign counts, that of the last half step or that at the instant, v + dt F/(2 m), as in YADE (default half_step)


class DampingContact(TypedDict, total=False):
    restitution: Number  # number, in [0, 1], or none: restitution coefficient of a free collision (default none)
    fraction: Number  # number, in (0, 1], or none: normal damping as a fraction of critical; instead of restitution (default none)


class Initial(TypedDict, total=False):
    random_velocity: Number  # number, m/s, in [0, 3e8]: velocity components drawn uniformly from +- this at the start (default 0)
    pulse: InitialPulse  # an initial plane wave of the shape 1 + cos, in particles and elements


class InitialPulse(TypedDict, total=False):
    direction: Vector  # [x, y, z], in 2D [x, y]: direction of propagation and of displacement; of any length
    centre: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: a point of the plane of the crest
    length: Number  # number, m, in [1e-9, 1e9]: length of the wave from front to end
    size: Number  # number, m, in [-1e9, 1e9]: displacement at the crest
    speed: Number  # number, m/s, in [-3e8, 3e8]: wave speed, sqrt(M/rho)


class Periodic(TypedDict, total=False):
    min: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: lower corner of the periodic box
    max: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: upper corner of the periodic box
    open: Literal['none', 'x', 'y', 'z']  # axis along which the box is open, as between two plates; min and max are not read along it (default none)
    x: PeriodicX  # motion of the sides across x by a stress or a rate; the lower corner is fixed
    y: PeriodicY  # motion of the sides across y by a stress or a rate; the lower corner is fixed
    z: PeriodicZ  # motion of the sides across z by a stress or a rate; the lower corner is fixed


class PeriodicX(TypedDict, total=False):
    stress: Table  # number, formula of t or table [[time, value], ...], Pa, in [-1e18, 1e18], or none: target mean normal stress of the specimen along this axis, compression positive; constant or a table; stress or rate (default none)
    stress_of: Literal['side', 'mean']  # side: stress is that along this axis; mean: it is the mean over all axes, which the sides with this word hold by equal stresses of their own (default side)
    rate: Table  # number, formula of t or table [[time, value], ...], 1/s, in [-1e6, 1e6], or none: prescribed growth of the length of the box over its length (default none)
    max_rate: Number  # number, 1/s, in (0, 1e6], or none: needed with stress: largest relative rate at which the box may shorten or lengthen (default none)
    relaxation: Number  # number, in (0, 1], or auto: with stress: fraction of the stress error corrected per step; reduced where stability of the time step requires it; auto: 0.1 (default auto)


class PeriodicY(TypedDict, total=False):
    stress: Table  # number, formula of t or table [[time, value], ...], Pa, in [-1e18, 1e18], or none: target mean normal stress of the specimen along this axis, compression positive; constant or a table; stress or rate (default none)
    stress_of: Literal['side', 'mean']  # side: stress is that along this axis; mean: it is the mean over all axes, which the sides with this word hold by equal stresses of their own (default side)
    rate: Table  # number, formula of t or table [[time, value], ...], 1/s, in [-1e6, 1e6], or none: prescribed growth of the length of the box over its length (default none)
    max_rate: Number  # number, 1/s, in (0, 1e6], or none: needed with stress: largest relative rate at which the box may shorten or lengthen (default none)
    relaxation: Number  # number, in (0, 1], or auto: with stress: fraction of the stress error corrected per step; reduced where stability of the time step requires it; auto: 0.1 (default auto)


class PeriodicZ(TypedDict, total=False):
    stress: Table  # number, formula of t or table [[time, value], ...], Pa, in [-1e18, 1e18], or none: target mean normal stress of the specimen along this axis, compression positive; constant or a table; stress or rate (default none)
    stress_of: Literal['side', 'mean']  # side: stress is that along this axis; mean: it is the mean over all axes, which the sides with this word hold by equal stresses of their own (default side)
    rate: Table  # number, formula of t or table [[time, value], ...], 1/s, in [-1e6, 1e6], or none: prescribed growth of the length of the box over its length (default none)
    max_rate: Number  # number, 1/s, in (0, 1e6], or none: needed with stress: largest relative rate at which the box may shorten or lengthen (default none)
    relaxation: Number  # number, in (0, 1], or auto: with stress: fraction of the stress error corrected per step; reduced where stability of the time step requires it; auto: 0.1 (default auto)


class Domain(TypedDict, total=False):
    min: Vector  # [x, y, z], in 2D [x, y], m: lower corner; default: the box of the specimen, enlarged by ten times its largest side on every side
    max: Vector  # [x, y, z], in 2D [x, y], m: upper corner; given together with min
    lost: Literal['stop', 'remove']  # reaction to a particle that leaves the domain; default in cutting tests: remove (default stop)


class Set(TypedDict, total=False):
    name: str  # name: name by which the rest of the scene refers to it
    select: SetSelect  # selection of particles; of several conditions all must hold
    material: str  # text: name of another material than the specimen's
    group: int | str  # whole number, in [0, 1000000], or keep: another cohesive group than the specimen's (default keep)
    initial_velocity: Vector  # [x, y, z], in 2D [x, y], m/s, in [-3e8, 3e8]: velocity at the start
    initial_spin: Number | Vector  # [x, y, z], in 2D a number, rad/s, in [-1e12, 1e12]: spin at the start; in 2D one number
    force: Tables  # [x, y, z], in 2D [x, y], of numbers, formulas of t or tables, N, in [-1e18, 1e18]: total force on the set, distributed by mass
    motion: SetMotion  # prescribed motion; each channel free, constant or a table [[time, value], ...]


class SetSelect(TypedDict, total=False):
    all: Literal['true', 'false'] | bool  # every particle (default false)
    box: SetSelectBox  # particles whose centres lie in a box
    ids: Sequence[int]  # list of whole numbers, in [0, 1e15]: indices of particles, base 0, in the order of the specimen
    end: SetSelectEnd  # particles at one end of the specimen


class SetSelectBox(TypedDict, total=False):
    min: Vector  # [x, y, z], in 2D [x, y], m: lower corner
    max: Vector  # [x, y, z], in 2D [x, y], m: upper corner


class SetSelectEnd(TypedDict, total=False):
    axis: Literal['x', 'y', 'z']  # axis along which the ends lie
    side: Literal['lower', 'upper']  # lower or upper end
    depth: Number  # number, m, in [1e-9, 1e9]: depth of the layer at the end of the specimen
    by: Literal['centre', 'surface']  # a particle is selected if its centre, or any part of its surface, lies within the depth (default centre)


class SetMotion(TypedDict, total=False):
    vx: Table  # number, formula of t or table [[time, value], ...], m/s, in [-3e8, 3e8], or free: prescribed velocity along x (default free)
    vy: Table  # number, formula of t or table [[time, value], ...], m/s, in [-3e8, 3e8], or free: prescribed velocity along y (default free)
    vz: Table  # number, formula of t or table [[time, value], ...], m/s, in [-3e8, 3e8], or free: prescribed velocity along z (default free)
    wx: Table  # number, formula of t or table [[time, value], ...], rad/s, in [-1e12, 1e12], or free: prescribed spin about x (default free)
    wy: Table  # number, formula of t or table [[time, value], ...], rad/s, in [-1e12, 1e12], or free: prescribed spin about y (default free)
    wz: Table  # number, formula of t or table [[time, value], ...], rad/s, in [-1e12, 1e12], or free: prescribed spin about z (default free)


class Wall(TypedDict, total=False):
    name: str  # name: name by which the rest of the scene refers to it
    point: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: a point of the plane
    normal: Vector  # [x, y, z], in 2D [x, y]: towards the particles; of any length
    stiffness: Number  # number, N/m, in [1e-15, 1e21], or none: penalty stiffness k_n; needed by every law but hertz (default none)
    material: str  # text: with hertz: name of the wall's material; left out: rigid, with its own friction and the restitution of the particles
    kratio: Number  # number, in [1e-6, 1e12], or none: k_n/k_t of the wall; needed with friction (default none)
    friction: Number  # number, or an angle, in [0, 1e30]: Coulomb friction coefficient (default 0)
    rolling_friction: Number  # number, in [0, 1e30]: mu_r, as for materials (default 0)
    twisting_friction: Number  # number, in [0, 1e30]: mu_t: contacts resist twisting up to the moment mu_t R |f_n|, R the reduced radius; 0: no resistance (default 0)
    passive: Literal['true', 'false'] | bool  # initial overlaps of particles with the wall are free of stress, as bonds with passive_gaps: a platen on a cut face (default false)
    motion: WallMotion  # velocity of the wall; free components are zero
    servo: WallServo  # moves the wall along its normal so that it carries a target force


class WallMotion(TypedDict, total=False):
    vx: Table  # number, formula of t or table [[time, value], ...], m/s, in [-3e8, 3e8], or free: velocity along x (default free)
    vy: Table  # number, formula of t or table [[time, value], ...], m/s, in [-3e8, 3e8], or free: velocity along y (default free)
    vz: Table  # number, formula of t or table [[time, value], ...], m/s, in [-3e8, 3e8], or free: velocity along z (default free)


class WallServo(TypedDict, total=False):
    force: Table  # number, formula of t or table [[time, value], ...], N, in [-1e18, 1e18], or none: target normal force, compression positive; constant or a table; force or stress (default none)
    stress: Table  # number, formula of t or table [[time, value], ...], Pa, in [-1e18, 1e18], or none: target normal stress on the area of the wall, compression positive; constant or a table; force or stress (default none)
    stress_of: Literal['side', 'mean']  # side: stress is that on this wall; mean: it is the mean over all axes of a box of walls, which the walls with this word hold by equal stresses of their own (default side)
    area: Number  # number, m2, in [1e-18, 1e18], or auto: area for stress; auto: the current section between the walls that face each other across this one (default auto)
    max_velocity: Number  # number, m/s, in (0, inf): largest velocity of the wall
    relaxation: Number  # number, in (0, 1]: fraction of the force error corrected per step; reduced where stability of the time step requires it (default 0.1)


class Body(TypedDict, total=False):
    name: str  # name: name by which the rest of the scene refers to it
    surface: str  # file: 3D shape: STL, PLY or OBJ file; a free body needs a closed surface that does not intersect itself, unless mass, inertia and reference are given
    box: BodyBox  # 3D shape; its lower corner is its origin
    cylinder: BodyCylinder  # 3D shape, axis along z; the centre of its lower end is its origin
    polygon: Rows  # list of at least 3 points [x, y], m, in [-1e9, 1e9]: 2D shape: closed line through its corners
    polyline: Rows  # list of at least 2 points [x, y], m, in [-1e9, 1e9]: 2D shape: open line through its points
    disc_cutter: BodyDiscCutter  # 3D shape: ring of constant cross section, axis along y; its centre is its origin
    chisel: BodyChisel  # shape: tool that cuts towards x, rock below it (in 3D below z, in 2D below y); the middle of its edge is its origin
    wedge: BodyWedge  # shape: symmetric tool with its edge along y, rock below it; the middle of its edge is its origin
    pick: BodyPick  # 3D shape: cone with its axis along z, rock below it; its lowest point is its origin
    scale: Number  # number, in [1e-12, 1e12]: lengths of the shape times this give metres (default 1)
    origin: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: position of the shape's origin (default 0)
    rotation: Number | Vector  # [x, y, z], in 2D a number, rad, in [-1e6, 1e6]: rotation vector (axis times angle) of the shape about its origin, applied before the shift; in 2D one number
    stiffness: Number  # number, N/m, in [1e-15, 1e21], or none: penalty stiffness k_n; needed by every law but hertz, where it holds for contacts with walls and other bodies (without it a free body has contacts with particles only) (default none)
    material: str  # text: with hertz: name of the material; left out: rigid, with its own friction and the restitution of the particles
    kratio: Number  # number, in [1e-6, 1e12], or none: k_n/k_t of the surface; needed with friction, with hertz only together with stiffness (default none)
    friction: Number  # number, or an angle, in [0, 1e30]: Coulomb friction coefficient (default 0)
    rolling_friction: Number  # number, in [0, 1e30]: mu_r, as for materials (default 0)
    twisting_friction: Number  # number, in [0, 1e30]: mu_t: contacts resist twisting up to the moment mu_t R |f_n|, R the reduced radius; 0: no resistance (default 0)
    reference: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: centre of rotation and reference of moments; default: the origin, for free bodies the centre of mass; given with mass and inertia it is the centre of mass
    free: Literal['true', 'false'] | bool  # components that motion leaves free follow the forces of particles and gravity (default false)
    density: Number  # number, kg/m3, in [1e-9, 1e15], or none: mass density; a free body needs it or its mass (default none)
    mass: Number  # number, kg, in [1e-21, 1e21], or none: mass of a free body, instead of its density (default none)
    inertia: Number | Vector  # [x, y, z], in 2D a number, kg m2, in [1e-36, 1e36]: moments of inertia of a free body about its centre of mass along x, y, z, which are its principal axes at the start; in 2D one number; default: those of the shape with uniform density
    initial_velocity: Vector  # [x, y, z], in 2D [x, y], m/s, in [-3e8, 3e8]: velocity of a free body at the start
    initial_spin: Number | Vector  # [x, y, z], in 2D a number, rad/s, in [-1e12, 1e12]: spin of a free body at the start; in 2D one number
    force: Tables  # [x, y, z], in 2D [x, y], of numbers, formulas of t or tables, N, in [-1e18, 1e18]: force on the centre of mass of a free body, along directions without prescribed motion
    motion: BodyMotion  # prescribed motion of the body; components left out are zero, in a free body free


class BodyBox(TypedDict, total=False):
    size: Vector  # [x, y, z], m, in [1e-9, 1e9]: lengths along x, y and z


class BodyCylinder(TypedDict, total=False):
    diameter: Number  # number, m, in [1e-9, 1e9]: diameter at the lower end, through the corners
    upper_diameter: Number  # number, m, in [1e-9, 1e9], or same: diameter at the upper end: a truncated cone, or a funnel when open (default same)
    height: Number  # number, m, in [1e-9, 1e9]: length along z
    sides: int | str  # whole number, in [3, 10000]: sides of the polygon that represents the circle (default 32)
    open: Literal['true', 'false'] | bool  # without end faces: a tube or a funnel (default false)


class BodyDiscCutter(TypedDict, total=False):
    diameter: Number  # number, m, in [1e-9, 1e9]: diameter of the tip
    tip_width: Number  # number, m, in [1e-9, 1e9]: width of the tip along y, between its edges before rounding
    tip_radius: Number  # number, m, in [0, 1e9]: radius of the rounding of the edges of the tip; 0: sharp (default 0)
    bevel_angle: Number  # number, rad, in (0, 3.14159265358979324]: angle between the two faces of the tip, which meet in a ridge; 180 deg: a flat tip (default 180 deg)
    flank_angle: Number  # number, rad, in [0, 1.5]: angle of the flanks with the plane of the ring (default 0)
    bore: Number  # number, m, in [1e-9, 1e9], or auto: inner diameter of the ring; auto: half of the outer one (default auto)
    facet: Number  # number, m, in [1e-9, 1e9], or auto: size of the facets at the tip, which grow along the flanks; auto: a sixth of the tip width (default auto)


class BodyChisel(TypedDict, total=False):
    width: Number  # number, m, in [1e-9, 1e9], or none: width along y; needed in 3D, in 2D 1 m (default none)
    rake_angle: Number  # number, rad, in (-1.5, 1.5): angle by which the front face leans back from the normal of the rock; negative: forward
    clearance_angle: Number  # number, rad, in [0, 1.5): angle between the lower face and the cut
    height: Number  # number, m, in [1e-9, 1e9]: height above the edge
    length: Number  # number, m, in [1e-9, 1e9]: length of the lower face along x
    tip_radius: Number  # number, m, in [0, 1e9]: radius of the rounding of the edges of the tip; 0: sharp (default 0)


class BodyWedge(TypedDict, total=False):
    width: Number  # number, m, in [1e-9, 1e9], or none: width along y; needed in 3D, in 2D 1 m (default none)
    angle: Number  # number, rad, in (0, 3.14159265358979324]: angle between the two faces
    height: Number  # number, m, in [1e-9, 1e9]: height above the edge
    tip_radius: Number  # number, m, in [0, 1e9]: radius of the rounding of the edges of the tip; 0: sharp (default 0)


class BodyPick(TypedDict, total=False):
    angle: Number  # number, rad, in (0, 3.14159265358979324]: angle of the tip, twice that of the cone with its axis
    diameter: Number  # number, m, in [1e-9, 1e9]: diameter of the cylinder behind the cone
    height: Number  # number, m, in [1e-9, 1e9]: height above the tip
    tip_radius: Number  # number, m, in [0, 1e9]: radius of the rounding of the edges of the tip; 0: sharp (default 0)
    facet: Number  # number, m, in [1e-9, 1e9], or auto: size of the facets at the tip; auto: a twelfth of the diameter (default auto)


class BodyMotion(TypedDict, total=False):
    vx: Table  # number, formula of t or table [[time, value], ...], m/s, in [-3e8, 3e8], or free: velocity of the reference point along x (default free)
    vy: Table  # number, formula of t or table [[time, value], ...], m/s, in [-3e8, 3e8], or free: velocity of the reference point along y (default free)
    vz: Table  # number, formula of t or table [[time, value], ...], m/s, in [-3e8, 3e8], or free: velocity of the reference point along z (default free)
    wx: Table  # number, formula of t or table [[time, value], ...], rad/s, in [-1e12, 1e12], or free: spin about x (default free)
    wy: Table  # number, formula of t or table [[time, value], ...], rad/s, in [-1e12, 1e12], or free: spin about y (default free)
    wz: Table  # number, formula of t or table [[time, value], ...], rad/s, in [-1e12, 1e12], or free: spin about z (default free)


class Joint(TypedDict, total=False):
    name: str  # name: name in the columns of the history
    point: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: a point of the joint, the centre of a disc; point, trace, surface, discs or network
    normal: Vector  # [x, y, z], in 2D [x, y]: normal of the joint, of any length; normal or dip
    dip: Number  # number, rad, in [0, 1.5707963267948966], or none: angle of the joint to the plane of x and y; in 2D to x, downwards along x (default none)
    dip_direction: Number  # number, rad, in [-7, 7]: direction of the steepest descent, from y towards x; 3D (default 0)
    radius: Number  # number, m, in [1e-9, 1e9], or none: radius of a disc, in 2D half of the length; none: the joint has no edge; of a network the smallest radius (default none)
    polygon: Rows  # list of at least 3 points [x, y], m, in [-1e9, 1e9]: corners of the joint in its plane in either sense of rotation: rows [along the strike, up the dip] from `point`
    trace: Rows  # list of at least 2 points [x, y], m, in [-1e9, 1e9]: corners of a line in a 2D scene: rows [x, y]
    surface: str  # file: STL, PLY or OBJ file of a surface of triangles, in m
    discs: str  # file: CSV file of discs: rows x, y, z, dip, dip direction, radius in m and degrees; in 2D of lines: x, y, dip, half of the length
    network: JointNetwork  # discs (in 2D lines) drawn at random by run.seed, with the mean normal and the smallest radius of the entry
    normal_stiffness: Number  # number, Pa/m, in [1e-9, 1e24]: normal stress per closure
    shear_stiffness: Number  # number, Pa/m, in [1e-9, 1e24]: shear stress per shear displacement before sliding
    friction: Number  # number, or an angle, in [0, 1e30]: Coulomb friction coefficient once the joint is broken (residual) (default 0)
    bond_friction: Number  # number, or an angle, in [0, 1e30], or friction: coefficient of friction that adds to the cohesion of the intact joint (default friction)
    cohesion: Number  # number, Pa, in [0, 1e18]: shear strength of the intact joint without normal stress (default 0)
    tensile_strength: Number  # number, Pa, in [0, 1e18]: tensile strength of the intact joint (default 0)
    dilation: Number  # number, or an angle, in [0, 10]: opening per slip while the joint slides closed, or the angle of dilation (default 0)
    dilation_end: Number  # number, m, in [0, 1e9], or none: slip at which the dilation ends (default none)


class JointNetwork(TypedDict, total=False):
    intensity: Number  # number, 1/m, in [1e-9, 1e9]: area of joints per volume of the specimen (P32); in 2D length per area (P21)
    fisher: Number  # number, in [0, 1e6], or parallel: concentration kappa of Fisher's distribution of the normals about that of the entry; 0: uniform; in 2D of von Mises' distribution of twice the angle (default parallel)
    radius_max: Number  # number, m, in [1e-9, 1e9], or equal: largest radius; equal: all joints have `radius` (default equal)
    exponent: Number  # number, in [0, 20]: D of the power law between `radius` and radius_max: the number of joints larger than r falls as r^-D (default 3)


class Source(TypedDict, total=False):
    name: str  # name: name in the columns of the history
    rectangle: SourceRectangle  # 2D region; its lower left corner is at the origin
    disc: SourceDisc  # 2D region; its centre is at the origin
    polygon: Rows  # list of at least 3 points [x, y], m, in [-1e9, 1e9]: 2D region: its corners in either sense of rotation
    box: SourceBox  # 3D region; its lower corner is at the origin
    cylinder: SourceCylinder  # 3D region, axis along z; the centre of its lower end is at the origin
    origin: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: position of the origin of a rectangle, disc, box or cylinder (default 0)
    rate: Number  # number, count/s, in [1e-12, 1e12], or none: particles per second; rate or mass_rate (default none)
    mass_rate: Number  # number, kg/s, in [1e-18, 1e18], or none: mass of particles per second; rate or mass_rate (default none)
    start: Number  # number, s, in [0, 1e18]: time of the first particle (default 0)
    end: Number  # number, s, in (0, 1e18], or none: time after which no more particles are created (default none)
    total: int | str  # whole number, in [1, 1e9], or none: total number of particles (default none)
    mean_radius: Number  # number, m, in [1e-9, 1e9]: mean of the radii by number
    sizes: Literal['uniform', 'normal', 'sieve']  # distribution of the radii between the smallest and the largest: by number, or sieve: by the curve (default uniform)
    size_ratio: Number  # number, in [1, 100]: largest over smallest radius, with sizes uniform or normal; a sieve curve implies its own (default 1)
    size_variation: Number  # number, in [0, 1], or auto: standard deviation of the radii over their mean, with sizes normal; auto: a sixth of the range (default auto)
    sieve: Rows  # list of at least 2 points [x, y], in [0, 1]: with sizes sieve: rows [size over the largest, mass fraction that passes], from [smallest, 0] to [1, 1]
    material: str  # text: name of the material; may be left out when there is only one
    velocity: Vector  # [x, y, z], in 2D [x, y], m/s, in [-3e8, 3e8]: velocity of new particles (default 0)
    random_velocity: Number  # number, m/s, in [0, 3e8]: random velocity of new particles, added along each axis, uniform in plus or minus this (default 0)


class SourceRectangle(TypedDict, total=False):
    width: Number  # number, m, in [1e-9, 1e9]: length along x
    height: Number  # number, m, in [1e-9, 1e9]: length along y


class SourceDisc(TypedDict, total=False):
    diameter: Number  # number, m, in [1e-9, 1e9]: diameter of the disc


class SourceBox(TypedDict, total=False):
    size: Vector  # [x, y, z], m, in [1e-9, 1e9]: lengths along x, y and z


class SourceCylinder(TypedDict, total=False):
    diameter: Number  # number, m, in [1e-9, 1e9]: diameter of the cylinder
    height: Number  # number, m, in [1e-9, 1e9]: length along z


class Sink(TypedDict, total=False):
    name: str  # name: name in the columns of the history
    plane: SinkPlane  # particles wholly beyond the plane are removed; plane or a region
    rectangle: SinkRectangle  # 2D region; its lower left corner is at the origin
    disc: SinkDisc  # 2D region; its centre is at the origin
    polygon: Rows  # list of at least 3 points [x, y], m, in [-1e9, 1e9]: 2D region: its corners in either sense of rotation
    box: SinkBox  # 3D region; its lower corner is at the origin
    cylinder: SinkCylinder  # 3D region, axis along z; the centre of its lower end is at the origin
    origin: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: position of the origin of a rectangle, disc, box or cylinder (default 0)
    remove: Literal['true', 'false'] | bool  # false: a plane only counts the centres that cross it, less those that return (default true)


class SinkPlane(TypedDict, total=False):
    point: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: a point of the plane
    normal: Vector  # [x, y, z], in 2D [x, y]: direction out of the model; of any length


class SinkRectangle(TypedDict, total=False):
    width: Number  # number, m, in [1e-9, 1e9]: length along x
    height: Number  # number, m, in [1e-9, 1e9]: length along y


class SinkDisc(TypedDict, total=False):
    diameter: Number  # number, m, in [1e-9, 1e9]: diameter of the disc


class SinkBox(TypedDict, total=False):
    size: Vector  # [x, y, z], m, in [1e-9, 1e9]: lengths along x, y and z


class SinkCylinder(TypedDict, total=False):
    diameter: Number  # number, m, in [1e-9, 1e9]: diameter of the cylinder
    height: Number  # number, m, in [1e-9, 1e9]: length along z


class Clumps(TypedDict, total=False):
    shapes: Sequence[ClumpsShape]  # shapes of clumps
    placed: Sequence[ClumpsPlaced]  # clumps one by one
    file: str  # file: text file of rows: name of a shape, centre x y z in m, and as far as given the orientation as a unit quaternion w x y z, velocity x y z in m/s, spin x y z in rad/s
    filled: Sequence[ClumpsFilled]  # boxes filled at random by run.seed, with random orientations, so that clumps do not overlap each other


class ClumpsShape(TypedDict, total=False):
    name: str  # name: name by which placed, filled and file refer to it
    spheres: Rows  # list of rows, m, or a whole number in [1, 10000]: rows [x, y, z, r] (2D: [x, y, r]) in the frame of the shape, which may overlap; with surface: the number of spheres that fill it
    surface: str  # file: closed surface (STL, PLY, OBJ) that is filled with spheres; mass, centre and inertia are those of the surface
    scale: Number  # number, in [1e-12, 1e12]: lengths of the rows or of the surface times this give metres (default 1)
    material: str  # text: name of the material; may be left out when there is only one


class ClumpsPlaced(TypedDict, total=False):
    shape: str  # text: name of its shape
    centre: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: position of its centre of mass
    rotation: Number | Vector  # [x, y, z], in 2D a number, rad, in [-1e6, 1e6]: rotation vector (axis times angle) from the frame of the shape; in 2D one number
    velocity: Vector  # [x, y, z], in 2D [x, y], m/s, in [-3e8, 3e8]: velocity of the centre at the start (default 0)
    spin: Number | Vector  # [x, y, z], in 2D a number, rad/s, in [-1e12, 1e12]: spin at the start; in 2D one number


class ClumpsFilled(TypedDict, total=False):
    shapes: str | Sequence[str]  # name or list of names: names of one or several shapes, drawn with equal probability
    box: ClumpsFilledBox  # box that contains all spheres
    count: int | str  # whole number, in [1, 1e7]: number of clumps
    velocity: Vector  # [x, y, z], in 2D [x, y], m/s, in [-3e8, 3e8]: velocity at the start (default 0)


class ClumpsFilledBox(TypedDict, total=False):
    min: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: lower corner
    max: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: upper corner


class Membrane(TypedDict, total=False):
    pressure: Table  # number, formula of t or table [[time, value], ...], Pa, in [0, 1e18]: pressure along the inward normal; constant or a table in time
    ramp: Number  # number, s, in [0, inf): time over which the pressure rises linearly from 0; in a stage that changes the membrane, from the present pressure since the start of the stage (default 0)
    surface: Literal['shape', 'particles']  # surface that is loaded. shape: that of the specimen's shape; particles: that of the particles, which lies inside it, as for specimens without a shape (default shape)
    faces: Literal['all', 'sides']  # all of the surface, as in a pressure cell; or only the sides, which face across the axis (default all)
    axis: Literal['test', 'x', 'y', 'z']  # axis that the sides face across; test: the axis of the test (default test)
    follow: Literal['true', 'false'] | bool  # areas and normals rotate and stretch with the particles around them, so that the pressure is maintained; false: they stay as at the start, and an unsupported specimen turns over (default true)


class Test(TypedDict, total=False):
    kind: Literal['compression', 'tension', 'brazilian', 'bending', 'triaxial', 'biaxial', 'hydrostatic', 'polyaxial', 'oedometer', 'shear', 'simple_shear', 'cutting']  # kind of test, which decides the definitions of stress and strain and the readings; brazilian: a disc across its diameter, bending: a beam on two supports, triaxial (in 2D biaxial): under a membrane, hydrostatic: without ends, under pressure from all sides, polyaxial: without ends, a stress or motion on every side, oedometer: between fixed sides, shear: one half along the other, simple_shear: between periodic sides, cutting: a tool along the surface of a rock
    axis: Literal['none', 'x', 'y', 'z']  # direction of loading, or of the motion of the tool (cutting); needed by all but hydrostatic (default none)
    lower: str | Sequence[str]  # name or list of names: wall, body, set or motion of elements at the lower end; forces of several add up; needed by all but hydrostatic, polyaxial and cutting
    upper: str | Sequence[str]  # name or list of names: wall, body, set or motion of elements at the upper end; forces of several add up; needed by all but hydrostatic, polyaxial and cutting
    normal: Literal['none', 'x', 'y', 'z']  # shear and simple_shear: axis normal to the sheared plane; cutting: to the surface of the rock (default none)
    tool: str  # text: cutting: the body that cuts
    depth: Number  # number, m, in [1e-9, 1e9], or none: cutting: depth of the cut, to which energies and predictions refer (default none)
    spacing: Number  # number, m, in [1e-9, 1e9], or none: cutting: distance between neighbouring cuts (default none)
    run_in: Number  # number, m, in [0, 1e9], or none: cutting: path of the tool before means are taken; length is the path of the means (default none)
    blocks: int | str  # whole number, in [1, 10000]: cutting: number of parts of the path of the means, whose scatter is a reading (default 5)
    peak_window: Number  # number, m, in [1e-9, 1e9], or auto: cutting: path over which a peak force is averaged; auto: a quarter of the depth (default auto)
    compressive_strength: Number  # number, Pa, in [1e-12, 1e100], or none: cutting: uniaxial strength of the rock, used for predicted forces only (default none)
    tensile_strength: Number  # number, Pa, in [1e-12, 1e100], or none: cutting: Brazilian strength of the rock, used for predicted forces only (default none)
    pressure_exponent: Number  # number, in [-0.2, 0.2]: cutting: exponent psi of the pressure along the rim in the predicted forces, 0.2 of sharp to -0.2 of wide tips (default 0)
    length: Number  # number, m, in [1e-9, 1e9], or auto: length of the specimen; auto: its extent along the axis, in shear the free distance between the ends along the normal; cutting: path of the means, auto: until the tool leaves the rock, or comes near held particles (default auto)
    area: Number  # number, m2, in [1e-18, 1e18], or auto: area of the section of the specimen; auto: from the diameter, else the specimen's volume over the length (in shear its height) (default auto)
    diameter: Number  # number, m, in [1e-9, 1e9], or none: diameter of a cylinder; brazilian: of the disc, none: its extent along the axis (default none)
    thickness: Number  # number, m, in [1e-9, 1e9], or auto: thickness of the disc of a brazilian test, or of the beam of a bending test; auto: its extent, in 2D 1 m (default auto)
    span: Number  # number, m, in [1e-9, 1e9], or none: bending: distance of the supports (default none)
    load_span: Number  # number, m, in [1e-9, 1e9], or none: bending: distance of two loads (four points); none: one load at mid-span (default none)
    height: Number  # number, m, in [1e-9, 1e9], or auto: bending: height of the beam; auto: its extent along the axis (default auto)
    notch: Number  # number, m, in [1e-9, 1e9], or none: bending: depth of the notch at mid-span (default none)
    centre: Number  # number, in (0, 1]: brazilian: radius, over that of the disc, of the region around its centre whose mean stress is read (default 0.2)
    control: TestControl  # scales the prescribed motion of the ends along the axis, also to reverse it, so that a reading grows at a given rate, past a peak with snap-back
    confinement: Any  # triaxial and biaxial, at least three different pressures: gneiss run makes a run with each as membrane.pressure, side by side, and fits friction angle, cohesion and Hoek-Brown's m_i
    opening: TestOpening  # a gauge of the opening between two parts, such as the mouth of a notch


class TestControl(TypedDict, total=False):
    opening: Number  # number, m/s, in (0, 1e9], or none: target rate of the opening of the gauge; this or lateral_strain (default none)
    lateral_strain: Number  # number, 1/s, in (0, 1e9], or none: target rate of the average strain across the axis, extension positive; this or opening (default none)
    response: Number  # number, s, in (0, 1e9]: response time of the control: several transit times of waves through the specimen
    reverse: Number  # number, in [0, 10]: largest reverse velocity of the ends over their prescribed one; 0: they stop (default 1)


class TestOpening(TypedDict, total=False):
    axis: Literal['x', 'y', 'z']  # axis along which the opening is read
    lower: str | Sequence[str]  # name or list of names: wall, body, set or motion of elements on the lower side
    upper: str | Sequence[str]  # name or list of names: wall, body, set or motion of elements on the upper side


class Time(TypedDict, total=False):
    step: Number  # number, s, in (0, inf), or auto: time step; auto: safety times the stability limit (default auto)
    safety: Number  # number, in (0, 1]: automatic step as a fraction of the stability limit 2/w_max (default 0.9)
    contact_steps: Number  # number, in (0, inf), or auto: least number of steps in the shortest collision of unbonded particles, for an automatic step; auto: 10, with hertz 12, which keeps restitution within 1 % (default auto)
    estimate: Literal['sharp', 'bound']  # estimate of the stability limit: sharp by iteration, or a rigorous bound per particle (default sharp)
    mass_scaling: TimeMassScaling  # for quasi-static runs: mass and moment of inertia are raised for particles that would need a smaller step; none are lowered
    on_unstable: Literal['stop', 'warn']  # reaction to a step above the stability limit (default stop)
    end: Number  # number, s, in (0, inf): time at which the run ends
    start: Literal['rest', 'first_break']  # initial state: at rest; or first_break, the equilibrium shortly before the first bond breaks, found by statics (default rest)
    start_fraction: Number  # number, in (0, 1): with first_break: initial time as a fraction of the time of the first break (default 0.9)
    stop: TimeStop | str  # conditions that end the run earlier; none: the run lasts to its end


class TimeMassScaling(TypedDict, total=False):
    step: Number  # number, s, in (0, inf), or none: target time step, safety included (default none)
    factor: Number  # number, in [1, 1000], or none: target time step over the step without added mass; step or factor (default none)
    gravity: Literal['refuse', 'own_mass']  # own_mass: particles keep their weight, and so fall more slowly; needed in a scene with gravity (default refuse)


class TimeStop(TypedDict, total=False):
    peak_drop: Number  # number, in (0, 1), or off, or auto: stop once stress has fallen by this fraction of its peak; auto: the default of the kind of test, together with other conditions; this default also holds if no condition of stop is given (default auto)
    strain: Number  # number, in (0, inf), or off: stop at this strain (default off)
    unbalanced: Number  # number, in (0, inf), or off: stop once the unbalanced force ratio is below this, after 20 rows, while some contacts carry load and no particle falls freely (default off)


class Stage(TypedDict, total=False):
    name: str  # name: name of the stage
    end: StageEnd  # conditions that end the stage, whichever comes first; the last stage may omit them and ends at time.end
    title: str  # text: one line for reports
    dimension: int | str  # whole number, in [2, 3]: 2: discs in plane strain; 3: spheres (default 3)
    origin: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: origin of the coordinates of the computation; left out: near the model if that lies far from 0, else 0
    specimen: Specimen  # the particles at the start; specimen, sources, elements or several of them
    materials: Sequence[Material] | dict[str, Material]  # materials of particles; needed with a specimen
    contacts: Sequence[Contact] | dict[str, Contact]  # values of contacts between two materials (or one with itself) that replace those from the materials
    law: Law  # the contact law; needed with a specimen
    elements: Elements  # finite elements: linear triangles in plane strain or tetrahedra
    couple: Couple  # coupling of particles and elements in zones that both share
    bonds: Bonds  # brittle bonds between particles of one group
    damping: Damping  # dissipation in addition to friction and breakage
    gravity: Tables  # [x, y, z], in 2D [x, y], of numbers, formulas of t or tables, m/s2, in [-1e12, 1e12]: acceleration of free fall (default 0)
    initial: Initial  # the state at the start
    periodic: Periodic  # a periodic box
    domain: Domain  # region of space that particles must not leave
    sets: Sequence[Set] | dict[str, Set]  # selections of particles and actions on them; a later one overrides an earlier one
    walls: Sequence[Wall] | dict[str, Wall]  # plane walls
    bodies: Sequence[Body] | dict[str, Body]  # rigid bodies with a surface of triangles (2D: segments)
    joints: Sequence[Joint] | dict[str, Joint]  # joints in the specimen; contacts that cross one follow the law of the joint
    sources: Sequence[Source] | dict[str, Source]  # regions where particles are created during the run
    sinks: Sequence[Sink] | dict[str, Sink]  # regions where particles are removed and counted; each sink takes those that earlier ones leave
    clumps: Clumps  # rigid clumps of particles that may overlap within one
    membrane: Membrane  # pressure on the surface of the specimen
    test: Test  # a laboratory test, for which stress and strain are read
    time: Time  # step and duration
    output: Output  # files that a run writes
    neighbours: Neighbours  # the neighbour list
    run: Run  # execution of the run; no physics


class StageEnd(TypedDict, total=False):
    time: Number  # number, s, in [0, inf), or none: the stage ends after this time since its start (default none)
    steps: int | str  # whole number, in [0, 1e15], or none: the stage ends after this number of steps; 0: its changes take effect, and the next stage begins (default none)
    strain: Number  # number, in (0, inf), or none: the stage ends once the strain of the test has grown by this since its start (default none)
    stress: Number  # number, Pa, in [1e-12, 1e100], or none: the stage ends once the stress of the test is at least this (default none)
    peak_drop: Number  # number, in (0, 1), or none: the stage ends once stress has fallen by this fraction of its peak in the stage (default none)
    unbalanced: Number  # number, in (0, inf), or none: the stage ends once the unbalanced force ratio is below this, after 20 rows, while some contacts carry load and no particle falls freely (default none)
    held: Number  # number, in (0, 1), or none: the stage ends once every servo, of walls and of a periodic box, has been within this fraction of its force or stress for ten rows of the history; without servos, the mean stress within this fraction of the pressure of the membrane (always true at zero pressure) (default none)


class Output(TypedDict, total=False):
    directory: str  # text: folder of the results; left out: runs/ and the name of the scene
    history_rows: int | str  # whole number, in [0, 10000000]: rows of the history up to time.end; up to twice as many if a test ends before (default 1000)
    structure: OutputStructure  # box in which porosity, coordination, fabric and sliding contacts of the history are measured; left out: the whole specimen
    snapshots: int | str  # whole number, in [0, 1000000]: snapshots up to the end, besides those at the peak of a test and at half of it; 0: only the last state (default 10)
    checkpoint: Number  # number, s, in [0, inf), or off: wall time between checkpoints; off: only on a signal and at the end (default 5 min)
    energy: Literal['auto', 'on', 'off'] | bool  # energy ledger; auto: on (default auto)
    orientation: Literal['auto', 'on', 'off'] | bool  # rotations of particles since the start, in snapshots and results.h5, if they rotate; auto: off (default auto)
    events: Literal['auto', 'on', 'off'] | bool  # list of the times and places at which bonds broke, began to soften or to yield, in results.h5; auto: on (default auto)
    contacts: Literal['auto', 'on', 'off'] | bool  # all acting contacts, including unbonded ones and those with walls and bodies, in snapshots and results.h5; auto: off (default auto)
    burst_reach: Number  # number, in [0, 1e6]: breaks belong to one burst if they are at most this many mean diameters of bonded particles apart, and in time at most what a wave takes over that distance (default 5)
    fields: str | Sequence[str]  # name or list of names: further quantities of particles and bonds in snapshots and results.h5: spin, group, material, skin, total_force, total_moment, damping_force, damping_moment, fragment, fragment_size, area, shear_stress (docs/quantities.md)


class OutputStructure(TypedDict, total=False):
    min: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: lower corner of the box
    max: Vector  # [x, y, z], in 2D [x, y], m, in [-1e9, 1e9]: upper corner of the box


class Neighbours(TypedDict, total=False):
    skin: Number  # number, m, in [1e-12, 1e9], or auto: extra distance of the neighbour list, so that it is rebuilt rarely; raised to the largest relative displacement of two particles in a step (default auto)


class Run(TypedDict, total=False):
    seed: int | str  # whole number: seed of all random numbers (default 1)
    threads: int | str  # whole number, in [0, 1024], or auto: number of threads; auto or 0: all cores (default auto)
    precision: Literal['double', 'mixed']  # precision of the kernels of contacts and elements (displacement form); mixed: single, with positions and motion in double (default double)
    isa: Literal['auto', 'scalar', 'avx2', 'avx512', 'neon']  # instruction set of the kernels; auto: the widest one of the machine (default auto)
    residual_warning: Number  # number, in (0, inf), or off: residual of the energy ledger, over the energy exchanged, above which a run ends with a warning (default 1 %)
    residual_limit: Number  # number, in (0, inf), or off: residual of the energy ledger, over the energy exchanged, above which a run is invalid: it stops, or ends, with exit code 5 (default 10 %)
