// Texts about parameters in place of those that the server sends, by the names in the registry.
import type * as english from "../texts/registry";

import {localised} from "./numbers";

export const topic_titles: typeof english.topic_titles = {
  experiment: "Experiment",
  islands: "Inseln",
  food_and_poison: "Futter und Gift",
  obstacles_and_crates: "Hindernisse und Kisten",
  items: "Futter- und Giftstücke",
  health_and_behaviour: "Gesundheit und Verhalten",
  physics: "Physik",
  from_genes_to_bodies: "Von Genen zu Körpern",
  costs_of_genes: "Kosten der Gene",
  population: "Population",
  selection: "Selektion",
  crossover: "Rekombination (Crossover)",
  mutation: "Mutation",
  bounds_of_genes: "Grenzen der Gene",
  end_of_the_run: "Ende des Laufs",
  migration: "Migration",
};

export const parameter_labels: typeof english.parameter_labels = {
  fitness: "Fitnessfunktion",
  objectives: "Ziele",
  external_bodies: "Körper bei fremder Fitness",
  fitness_per_second: "Fitness je Sekunde",
  fitness_per_health: "Fitness je Gesundheit",
  fitness_per_food: "Fitness je Futter",
  fitness_per_poison: "Fitness je Gift",
  generation_s: "Dauer einer Generation",
  tick_s: "Tick",

  island_count: "Anzahl der Inseln",
  island_width_px: "Breite der Insel",
  island_height_px: "Höhe der Insel",

  food_count: "Futtermenge",
  poison_count: "Giftmenge",
  scale_with_population: "Mit der Population wachsen",
  reference_population: "Bezugspopulation",
  spawn_margin_px: "Randabstand",

  obstacle_count: "Hindernisse",
  obstacle_size_px: "Größe der Hindernisse",
  crate_count: "Kisten",
  crate_size_px: "Größe der Kisten",
  crate_mass_kg: "Masse der Kisten",

  item_radius_px: "Radius der Stücke",
  respawn: "Nachwachsen",
  respawn_s: "Zeit bis zum Nachwachsen",

  health_loss_per_s: "Gesundheitsverlust",
  food_health: "Nährwert des Futters",
  poison_harm: "Schaden durch Gift",
  steering_lookahead_s: "Vorausschau beim Steuern",
  flee_rule: "Fluchtregel",
  flee_certain_impulse: "Impuls für sichere Flucht",

  damping: "Dämpfung",
  restitution: "Elastizität",
  max_speed_px_s: "Höchstgeschwindigkeit",
  integrator: "Integrator",

  radius_per_unit_px: "Radius je Gen-Einheit",
  mass_per_unit_kg: "Masse je Gen-Einheit",
  force_per_unit: "Kraft je Gen-Einheit",
  turn_rate_max_deg_s: "Größte Drehrate",
  acceleration_max_px_s2: "Größte Beschleunigung",

  normal_speed_cost: "Kosten von Normaltempo",
  impulse_cost: "Kosten von Impuls",
  base_health_cost: "Kosten von Grundgesundheit",
  food_radius_cost: "Kosten von Futterradius",
  poison_radius_cost: "Kosten von Giftradius",
  health_cap_per_size: "Gesundheitsgrenze je Größe",

  population_size: "Populationsgröße",
  population_model: "Populationsmodell",
  survivors: "Überlebende",
  replaced_count: "Anzahl der Ersetzten",
  elite_count: "Größe der Elite",
  mutate_survivors: "Überlebende mutieren",
  shuffle_fitness: "Fitness mischen",

  fitness_scaling: "Skalierung der Fitness",
  ranking_pressure: "Selektionsdruck der Ränge",
  ranking_decay: "Abnahme je Rang",
  selection: "Selektion",
  tournament_size: "Turniergröße",
  tournament_winners: "Sieger je Turnier",
  tournament_replacement: "Turnier mit Zurücklegen",

  crossover: "Rekombination",
  crossover_chance: "Wahrscheinlichkeit der Rekombination",
  crossover_cuts: "Anzahl der Schnitte",
  crossover_spread_index: "Streuindex der Rekombination",
  mutate_group: "Mutierende Gene",

  rearranging: "Umordnung",
  rearrange_chance: "Wahrscheinlichkeit der Umordnung",
  creep: "Kleine Schritte",
  mutation_chance: "Mutationsrate",
  mutation_step: "Mutationsschritt",
  brain_mutation_step: "Mutationsschritt des Gehirns",
  free_mutation_step: "Mutationsschritt freier Gene",
  mutation_spread_index: "Streuindex der Mutation",
  reset_chance: "Wahrscheinlichkeit neuer Werte",
  scale_chance: "Wahrscheinlichkeit der Multiplikation",
  scale_range: "Bereich der Multiplikation",
  bit_flip_chance: "Wahrscheinlichkeit je Bit",
  bit_flip_bits: "Bits eines Gens",
  out_of_bounds: "Jenseits der Grenzen",

  initial_gene_min: "Kleinster Anfangswert",
  initial_gene_max: "Größter Anfangswert",
  normal_speed_min: "Normaltempo, kleinster Wert",
  normal_speed_max: "Normaltempo, größter Wert",
  impulse_min: "Impuls, kleinster Wert",
  impulse_max: "Impuls, größter Wert",
  body_size_min: "Körpergröße, kleinster Wert",
  body_size_max: "Körpergröße, größter Wert",
  base_health_min: "Grundgesundheit, kleinster Wert",
  base_health_max: "Grundgesundheit, größter Wert",
  food_radius_min: "Futterradius, kleinster Wert",
  food_radius_max: "Futterradius, größter Wert",
  poison_radius_min: "Giftradius, kleinster Wert",
  poison_radius_max: "Giftradius, größter Wert",
  free_genes: "Freie Gene",
  free_gene_min: "Freie Gene, kleinster Wert",
  free_gene_max: "Freie Gene, größter Wert",
  free_gene_start: "Anfang der freien Gene",
  controller: "Steuerung",
  sense_food: "Futter wahrnehmen",
  sense_poison: "Gift wahrnehmen",
  sense_bearing_only: "Nur Richtungen wahrnehmen",
  sense_speed: "Tempo wahrnehmen",
  sense_health: "Gesundheit wahrnehmen",
  sense_wall: "Wand wahrnehmen",
  brain_bias: "Bias-Gewichte",
  brain_hidden: "Verdeckte Neuronen",
  brain_weight_limit: "Grenze der Gewichte",
  brain_weight_initial: "Anfangsbereich der Gewichte",
  locomotion: "Fortbewegung",

  generation_limit: "Höchstzahl der Generationen",
  stop_at_target_fitness: "Ende bei Ziel-Fitness",
  target_fitness: "Ziel-Fitness",
  stagnation_limit: "Höchste Dauer ohne Fortschritt",
  stop_at_extinction: "Ende beim Aussterben",

  migration: "Migration",
  migration_epoch: "Abstand der Migrationen",
  migrant_count: "Anzahl der Auswanderer",
  emigrants: "Auswanderer",
  immigrants_replace: "Einwanderer ersetzen",
};

export const parameter_helps: typeof english.parameter_helps = {
  fitness: "Wonach Organismen bewertet werden.",
  objectives: "Zahlen, mit denen ein Programm jeden Organismus bewertet, wenn es die Fitness bestimmt.",
  external_bodies: "Ob Organismen auf den Inseln leben, bevor ein Programm sie bewertet.",
  fitness_per_second: "Gewicht jeder gelebten Sekunde in der Fitness.",
  fitness_per_health: "Gewicht jeder Einheit Gesundheit am Ende in der Fitness.",
  fitness_per_food: "Gewicht jedes gefressenen Stücks Futter in der Fitness.",
  fitness_per_poison: "Gewicht jedes gefressenen Stücks Gift in der Fitness; negative Werte bestrafen es.",
  generation_s: "Länge einer Generation; sie endet früher, wenn alle Organismen sterben.",
  tick_s: "Simulierte Zeit je Tick.",

  island_count: "Anzahl der Inseln; außer durch Migration sind sie unabhängig.",
  island_width_px: "Abstand zwischen linker und rechter Wand.",
  island_height_px: "Abstand zwischen oberer und unterer Wand.",

  food_count: "Stücke Futter auf jeder Insel.",
  poison_count: "Stücke Gift auf jeder Insel.",
  scale_with_population: "Ob Fläche, Futter und Gift jeder Insel mit der Populationsgröße wachsen.",
  reference_population:
    "Die Populationsgröße, für die Inselgröße, Futtermenge und Giftmenge gelten, wenn sie mitwachsen.",
  spawn_margin_px: "Kleinster Abstand, den Organismen und Gegenstände am Anfang von jeder Wand haben.",

  obstacle_count: "Unbewegliche Rechtecke auf jeder Insel.",
  obstacle_size_px: "Seitenlänge eines Hindernisses.",
  crate_count: "Bewegliche Rechtecke auf jeder Insel.",
  crate_size_px: "Seitenlänge einer Kiste.",
  crate_mass_kg: "Masse einer Kiste.",

  item_radius_px: "Radius von Futter und Gift.",
  respawn: "Ob gefressenes Futter und Gift wieder erscheinen.",
  respawn_s: "Zeit, bis ein gefressenes Stück wieder erscheint; 0 bedeutet: beim nächsten Tick.",

  health_loss_per_s: "Gesundheit, die ein Organismus in jeder Sekunde verliert.",
  food_health: "Gesundheit, die ein Stück Futter gibt.",
  poison_harm: "Gesundheit, die ein Stück Gift nimmt.",
  steering_lookahead_s: "Wie weit ein Organismus vorausdenkt, wenn er auf Futter zusteuert; bei 0 umkreist er es.",
  flee_rule: "Wann ein Organismus vor Gift fliehen kann, das er sieht.",
  flee_certain_impulse:
    "Wert des Gens Impuls, bei dem ein Organismus sicher flieht; darunter ist die Wahrscheinlichkeit " +
    "kleiner.",

  damping: "Anteil seiner Geschwindigkeit, den ein Körper nach 1/60 s behält.",
  restitution: "Wie schnell sich zwei Körper nach einem Stoß trennen, als Anteil der Geschwindigkeit davor.",
  max_speed_px_s: "Höchste Geschwindigkeit eines Körpers.",
  integrator: "Wie ein Tick Geschwindigkeiten und Positionen berechnet.",

  radius_per_unit_px: "Radius je Einheit des Gens Körpergröße.",
  mass_per_unit_kg: "Masse je Einheit des Gens Körpergröße.",
  force_per_unit: "Kraft je Einheit der Gene Normaltempo und Impuls.",
  turn_rate_max_deg_s: "Drehrate eines Organismus, dessen Netz am Ausgang für Drehung 1 hat.",
  acceleration_max_px_s2: "Beschleunigung eines Organismus, dessen Netz am Ausgang für Beschleunigung 1 hat.",

  normal_speed_cost: "Kosten des Gens Normaltempo: Je größer sein Wert, desto schneller sinkt die Gesundheit.",
  impulse_cost: "Kosten des Gens Impuls: Je größer sein Wert, desto schneller sinkt die Gesundheit.",
  base_health_cost: "Kosten des Gens Grundgesundheit: Je größer sein Wert, desto schneller sinkt die Gesundheit.",
  food_radius_cost: "Kosten des Gens Futterradius: Je größer sein Wert, desto schneller sinkt die Gesundheit.",
  poison_radius_cost: "Kosten des Gens Giftradius: Je größer sein Wert, desto schneller sinkt die Gesundheit.",
  health_cap_per_size: "Obergrenze der Gesundheit nach dem Fressen, je Einheit des Gens Körpergröße; 0: keine Grenze.",

  population_size: "Organismen auf jeder Insel.",
  population_model: "Wie eine Generation die vorige ersetzt.",
  survivors: "Anteil der Population, der überlebt und sich fortpflanzt.",
  replaced_count: "Anzahl der schlechtesten Organismen, die jede Generation ersetzt (fortlaufend).",
  elite_count: "Anzahl der besten Organismen, die unverändert überleben.",
  mutate_survivors: "Ob auch Überlebende mutieren; die Elite nie.",
  shuffle_fitness: "Ob die Fitness vor der Selektion unter den Organismen einer Insel gemischt wird: ein " +
    "Kontrollversuch, in dem kein Gen einen Vorteil hat.",

  fitness_scaling: "Wie die Fitness vor der Selektion mit dem Glücksrad umgerechnet wird.",
  ranking_pressure: "Erwartete Kopien des besten Organismus bei linearer Rangfolge; 1 übt keinen Selektionsdruck aus.",
  ranking_decay: "Gewicht jedes Rangs im Verhältnis zum nächstbesseren bei exponentieller Rangfolge.",
  selection: "Wie die Eltern ausgewählt werden.",
  tournament_size: "Teilnehmer je Turnier.",
  tournament_winners: "Sieger je Turnier; höchstens so viele wie Teilnehmer.",
  tournament_replacement: "Ob ein Organismus mehrmals in dasselbe Turnier gelost werden kann.",

  crossover: "Wie die Gene zweier Eltern gemischt werden.",
  crossover_chance: "Wahrscheinlichkeit, dass die Gene eines Paars gemischt werden; sonst sind die Kinder Kopien.",
  crossover_cuts: "Anzahl der Schnittstellen bei mehreren Schnitten.",
  crossover_spread_index:
    "Verteilung bei simuliert-binärer Rekombination: Je größer, desto näher sind Kinder den Eltern.",
  mutate_group: "Welche Gene mutieren.",

  rearranging: "Wie die Werte von Genen innerhalb eines Chromosoms vertauscht werden.",
  rearrange_chance: "Wahrscheinlichkeit je Chromosom, dass Gene umgeordnet werden.",
  creep: "Verteilung des Schritts, um den eine Mutation ein Gen ändert.",
  mutation_chance: "Wahrscheinlichkeit je Gen, dass es um einen kleinen Schritt mutiert.",
  mutation_step: "Größe des Schritts bei einem Gen des Körpers: größter Schritt bei gleichverteilten Schritten, " +
    "Standardabweichung bei normalverteilten.",
  brain_mutation_step: "Größe des Schritts bei einem Gewicht des Gehirns.",
  free_mutation_step: "Größe des Schritts bei einem freien Gen.",
  mutation_spread_index: "Verteilung polynomialer Schritte: Je größer, desto kleiner sind die Schritte.",
  reset_chance: "Wahrscheinlichkeit je Gen, dass es einen zufälligen Wert innerhalb seiner Grenzen erhält; 0: nie.",
  scale_chance: "Wahrscheinlichkeit je Chromosom, dass ein Gen mit einem zufälligen Faktor multipliziert wird; 0: nie.",
  scale_range: "Bereich dieses Faktors: gleichverteilt zwischen 1 minus und 1 plus diesem Wert.",
  bit_flip_chance: "Wahrscheinlichkeit je Bit, dass es im Binärcode eines Gens kippt; 0: nie.",
  bit_flip_bits: "Anzahl der Bits im Binärcode eines Gens.",
  out_of_bounds: "Was mit einem Gen geschieht, das eine Mutation über seine Grenzen führt.",

  initial_gene_min: "Kleinster Wert eines Gens des Körpers in der ersten Generation.",
  initial_gene_max: "Größter Wert eines Gens des Körpers in der ersten Generation.",
  normal_speed_min: "Untere Grenze des Gens Normaltempo.",
  normal_speed_max: "Obere Grenze des Gens Normaltempo.",
  impulse_min: "Untere Grenze des Gens Impuls.",
  impulse_max: "Obere Grenze des Gens Impuls.",
  body_size_min: "Untere Grenze des Gens Körpergröße.",
  body_size_max: "Obere Grenze des Gens Körpergröße.",
  base_health_min: "Untere Grenze des Gens Grundgesundheit.",
  base_health_max: "Obere Grenze des Gens Grundgesundheit.",
  food_radius_min: "Untere Grenze des Gens Futterradius.",
  food_radius_max: "Obere Grenze des Gens Futterradius.",
  poison_radius_min: "Untere Grenze des Gens Giftradius.",
  poison_radius_max: "Obere Grenze des Gens Giftradius.",
  free_genes: "Gene über die des Körpers hinaus, die die Simulation nicht liest; für eine Fitness von außen.",
  free_gene_min: "Untere Grenze jedes freien Gens ohne eigene Beschreibung.",
  free_gene_max: "Obere Grenze jedes freien Gens ohne eigene Beschreibung.",
  free_gene_start: "Werte der freien Gene in der ersten Generation.",
  controller: "Was die Organismen steuert.",
  sense_food: "Ob Netze Eingänge für Richtung und Nähe des nächsten Futters haben, das zu sehen ist.",
  sense_poison: "Ob Netze Eingänge für Richtung und Nähe des nächsten Gifts haben, das zu sehen ist.",
  sense_bearing_only: "Ob Netze nur die Richtung, nicht die Nähe von Futter und Gift wahrnehmen.",
  sense_speed: "Ob Netze einen Eingang für das eigene Tempo haben.",
  sense_health: "Ob Netze einen Eingang für die eigene Gesundheit haben.",
  sense_wall: "Ob Netze einen Eingang für die Nähe der Wand voraus haben.",
  brain_bias: "Ob jedes Neuron eines Netzes ein Bias-Gewicht hat.",
  brain_hidden: "Neuronen in der verdeckten Schicht eines Netzes.",
  brain_weight_limit: "Gewichte eines Netzes bleiben innerhalb von ± diesem Wert.",
  brain_weight_initial: "Gewichte der ersten Generation sind gleichverteilt innerhalb von ± diesem Wert.",
  locomotion: "Was die Ausgänge eines Netzes bewirken.",

  generation_limit: "Der Lauf endet nach so vielen Generationen; 0: keine Grenze.",
  stop_at_target_fitness: "Ob der Lauf endet, wenn ein Organismus die Ziel-Fitness erreicht.",
  target_fitness: "Fitness, bei der der Lauf endet, wenn das eingeschaltet ist.",
  stagnation_limit: "Der Lauf endet nach so vielen Generationen ohne neue beste Fitness; 0: nie.",
  stop_at_extinction: "Ob der Lauf mit einer Generation endet, in der alle Organismen gestorben sind.",

  migration: "Welche Inseln Auswanderer austauschen.",
  migration_epoch: "Anzahl der Generationen von einer Migration zur nächsten.",
  migrant_count: "Anzahl der Organismen, die eine Insel auf jede Zielinsel kopiert.",
  emigrants: "Welche Organismen auf andere Inseln kopiert werden.",
  immigrants_replace: "Welche Organismen der Zielinsel die Einwanderer ersetzen.",
};

export const choice_labels: typeof english.choice_labels = {
  life: "Leben",
  gene_sum: "Summe der Gene",
  rastrigin: "Rastrigin-Funktion",
  external: "von außen",
  nearer: "wenn näher",
  always: "immer",
  symplectic_euler: "symplektischer Euler",
  explicit_euler: "expliziter Euler",
  backward_euler: "Rückwärts-Euler",
  hybrid: "gemischt",
  generational: "Generationenwechsel",
  steady_state: "fortlaufend",
  nsga2: "NSGA-II",
  none: "ohne",
  windowing: "Abzug des Minimums",
  linear_ranking: "lineare Rangfolge",
  exponential_ranking: "exponentielle Rangfolge",
  roulette: "Glücksrad",
  stochastic_universal: "universelle Stichprobe",
  tournament: "Turnier",
  random: "zufällig",
  truncation: "Kappung",
  uniform: "gleichverteilt",
  single_point: "ein Schnitt",
  multi_point: "mehrere Schnitte",
  blend: "Mittelwerte",
  simulated_binary: "simuliert binär",
  all: "alle",
  body: "Körper",
  brain: "Gehirn",
  free: "freie",
  swap: "Tausch",
  scramble: "Durchmischen",
  inversion: "Umkehrung",
  gaussian: "normalverteilt",
  polynomial: "polynomial",
  clamp: "begrenzen",
  reflect: "spiegeln",
  redraw: "neu auslosen",
  latin_hypercube: "Latin Hypercube",
  rules: "feste Regeln",
  network: "neuronales Netz",
  newtonian: "newtonsch",
  kinematic: "kinematisch",
  ring: "Ring",
  fully_connected: "jede mit jeder",
  best: "beste",
  worst: "schlechteste",
};

export const choice_helps: typeof english.choice_helps = {
  "fitness life": "Gelebte Sekunden plus Gesundheit am Ende der Generation.",
  "fitness gene_sum": "Die Summe der Gene des Körpers.",
  "fitness rastrigin": "Die Rastrigin-Funktion der Gene des Körpers, eine Testaufgabe mit vielen lokalen Optima.",
  "fitness external": "Zahlen, die ein Programm am Ende jeder Generation sendet, für beliebige Funktionen.",
  "flee_rule nearer": "Ein Organismus flieht nur, wenn das Gift näher ist als alles Futter, das er sieht.",
  "flee_rule always": "Ein Organismus flieht vor Gift, das er sieht, auch wenn Futter näher ist.",
  "integrator symplectic_euler":
    "Positionen benutzen die neuen Geschwindigkeiten; die Energie einer Feder bleibt begrenzt.",
  "integrator explicit_euler": "Positionen benutzen die alten Geschwindigkeiten; die Energie einer Feder wächst.",
  "integrator backward_euler": "Die Dämpfung benutzt die neuen Geschwindigkeiten; stabil für jede Länge eines Ticks.",
  "population_model hybrid": "Die ausgewählten Organismen bleiben, und ihre Kinder füllen die anderen Plätze.",
  "population_model generational": "Kinder ersetzen alle Organismen außer der Elite.",
  "population_model steady_state": "Kinder ersetzen nur die schlechtesten Organismen.",
  "population_model nsga2":
    "Die besten Organismen bleiben, und ihre Kinder füllen die anderen Plätze; bei mehreren Zielen ist das NSGA-II.",
  "fitness_scaling none":
    "Die Fitness selbst ist das Gewicht eines Organismus. Ist eine negativ, wird zuerst die kleinste von allen " +
    "abgezogen.",
  "fitness_scaling windowing": "Die kleinste Fitness der Generation wird von jeder abgezogen.",
  "fitness_scaling linear_ranking": "Das Gewicht sinkt von Rang zu Rang um denselben Betrag.",
  "fitness_scaling exponential_ranking": "Das Gewicht sinkt von Rang zu Rang um denselben Faktor.",
  "selection roulette": "Jeder Elternteil wird mit einer Chance im Verhältnis zu seiner skalierten Fitness gezogen.",
  "selection stochastic_universal":
    "Wie das Glücksrad, aber eine einzige Drehung wählt alle Eltern, sodass der Zufall weniger ausmacht.",
  "selection tournament": "Einige Organismen werden zufällig ausgelost, und die fittesten von ihnen werden Eltern.",
  "selection random": "Jeder Organismus hat dieselbe Chance: Es gibt keinen Selektionsdruck.",
  "selection truncation": "Nur die fittesten Organismen werden Eltern, alle mit derselben Chance.",
  "crossover uniform": "Jedes Gen kommt mit derselben Chance von einem der beiden Eltern.",
  "crossover single_point":
    "Die Chromosomen beider Eltern werden an einer Stelle geschnitten und über Kreuz verbunden.",
  "crossover multi_point":
    "Die Chromosomen beider Eltern werden an mehreren Stellen geschnitten und abwechselnd verbunden.",
  "crossover blend":
    "Jedes Gen ist ein gewichtetes Mittel der Gene beider Eltern, mit einem zufälligen Gewicht je Paar.",
  "crossover none": "Die Kinder sind Kopien ihrer Eltern.",
  "crossover simulated_binary":
    "Jedes Gen eines Kindes liegt nahe bei dem eines Elternteils, in zufälligem Abstand im Verhältnis zum " +
    "Unterschied der Eltern.",
  "mutate_group all": "Jedes Gen kann mutieren.",
  "mutate_group body": "Nur die sechs Gene des Körpers mutieren.",
  "mutate_group brain": "Nur die Gewichte des neuronalen Netzes mutieren.",
  "mutate_group free": "Nur die Gene, die die Simulation nicht liest, mutieren.",
  "rearranging none": "Werte von Genen werden nicht vertauscht.",
  "rearranging swap": "Zwei Gene tauschen ihre Werte.",
  "rearranging scramble": "Die Werte benachbarter Gene werden gemischt.",
  "rearranging inversion": "Die Reihenfolge der Werte benachbarter Gene wird umgekehrt.",
  "creep uniform": "Jeder Schritt bis zum größten ist gleich wahrscheinlich.",
  "creep gaussian": "Kleine Schritte sind wahrscheinlicher als große.",
  "creep polynomial": "Kleine Schritte sind wahrscheinlicher als große, und keiner führt über die Grenzen.",
  "out_of_bounds clamp": "Das Gen erhält den Wert der näheren Grenze, sodass sich Werte an den Grenzen sammeln.",
  "out_of_bounds reflect": "Das Gen geht von der Grenze so weit zurück, wie es darüber hinaus gegangen wäre.",
  "out_of_bounds redraw": "Das Gen erhält einen zufälligen Wert innerhalb seiner Grenzen.",
  "free_gene_start uniform": "Jeder Wert eines Gens ist gleich wahrscheinlich.",
  "free_gene_start latin_hypercube": "In jedem gleich großen Teil des Bereichs eines Gens liegt ein Organismus.",
  "controller rules": "Organismen fliehen, suchen und streifen nach festen Regeln umher.",
  "controller network": "Ein neuronales Netz steuert jeden Organismus; seine Gewichte sind Gene.",
  "locomotion newtonian": "Das Netz bestimmt eine Kraft in Blickrichtung und eine Drehrate; Körper stoßen zusammen.",
  "locomotion kinematic": "Das Netz ändert Tempo und Richtung; Körper gehen durcheinander hindurch.",
  "migration none": "Die Inseln sind unabhängig.",
  "migration ring": "Jede Insel sendet an die nächste, die letzte an die erste.",
  "migration fully_connected": "Jede Insel sendet an jede andere.",
  "migration random": "Jede Insel sendet an eine andere, die jedes Mal ausgelost wird.",
  "emigrants best": "Die fittesten Organismen werden kopiert.",
  "emigrants random": "Die kopierten Organismen werden ausgelost.",
  "immigrants_replace worst": "Einwanderer ersetzen die am wenigsten fitten Organismen.",
  "immigrants_replace random": "Einwanderer ersetzen ausgeloste Organismen.",
};

export const unit_words: typeof english.unit_words = {
  "numbers": "Zahlen",
  "fitness/s": "Fitness/s",
  "fitness/health": "Fitness/Gesundheit",
  "fitness/item": "Fitness/Stück",
  "s": "s",
  "islands": "Inseln",
  "px": "px",
  "items": "Stück",
  "organisms": "Organismen",
  "obstacles": "Hindernisse",
  "crates": "Kisten",
  "kg": "kg",
  "health/s": "Punkte/s",
  "health": "Punkte",
  "gene units": "Gen-Einheiten",
  "share per 1/60 s": "Anteil je 1/60 s",
  "px/s": "px/s",
  "kg px/s²": "kg px/s²",
  "°/s": "°/s",
  "px/s²": "px/s²",
  "share": "Anteil",
  "chance": "Chance",
  "cuts": "Schnitte",
  "bits": "Bits",
  "genes": "Gene",
  "neurons": "Neuronen",
  "generations": "Generationen",
  "fitness": "Fitness",
};

export const unit_words_of_one: typeof english.unit_words_of_one = {
  Zahlen: "Zahl",
  Inseln: "Insel",
  Organismen: "Organismus",
  Hindernisse: "Hindernis",
  Kisten: "Kiste",
  Schnitte: "Schnitt",
  Gene: "Gen",
  Neuronen: "Neuron",
  Generationen: "Generation",
};

const number = "(-?[0-9]+(?:[.][0-9]+)?(?:e[+-]?[0-9]+)?)";

/** Numbers and ranges as the server writes them. */
const ranges: readonly(readonly[RegExp, string])[] = [
  [new RegExp(`^${number}$`), "$1"],
  [new RegExp(`^${number} to ${number}$`), "$1 bis $2"],
  [new RegExp(`^${number} to ${number} in generation ${number}$`), "$1 bis $2 in Generation $3"],
  [new RegExp(`^a whole number, ${number} to ${number}$`), "eine ganze Zahl, $1 bis $2"],
  [new RegExp(`^at most ${number}$`), "höchstens $1"],
  [new RegExp(`^at least ${number}$`), "mindestens $1"],
  [/^true or false$/, "ein oder aus"],
];

/** Limits by another parameter, as the server writes them. */
const limits: readonly(readonly[RegExp, string])[] = [
  [new RegExp(`^at most ([a-z_]+) [(]${number}[)]$`), "höchstens"],
  [new RegExp(`^at least ([a-z_]+) [(]${number}[)]$`), "mindestens"],
];

export const allowed_words: typeof english.allowed_words = (allowed) => {
  for (const [pattern, words] of ranges) {
    if (pattern.test(allowed)) {
      return localised_all(allowed.replace(pattern, words));
    }
  }
  for (const [pattern, words] of limits) {
    const [, name = "", limit = ""] = pattern.exec(allowed) ?? [];
    if (limit !== "") {
      return localised_all(`${words} ${limit} (${parameter_labels[name] ?? name})`);
    }
  }
  return allowed.split(", ").map((choice) => choice_labels[choice] ?? choice).join(", ");
};

function localised_all(text: string): string {
  return text.split(" ").map(localised).join(" ");
}
