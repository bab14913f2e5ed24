(* (i) The ego under a plan: its commands, when they take effect, and where they bring it. *)
Require Import Reals Lra Lia Psatz List.
Require Import Contract Shipped Motion Reach Statement.
Open Scope R_scope.

(** * What the printed functions are *)

(* The departure is three steps, each of the bound that the proof is about. *)
Lemma departure_is k sensed pl pm a :
  let most2 := at_most (at_most (start (sensed + speed_error k)) (Rmax pm a) (switching k)) a
                 (shortest_period k - switching k) in
  let least2 := at_least (at_least (start (sensed - speed_error k)) (Rmin pl a) (unlimited k) (switching k)) a
                  (unlimited k) (shortest_period k - switching k) in
  departure k sensed pl pm a = {|
    braking := at_most most2 a (switching k);
    most := at_most most2 (Rmax a (ego_go k)) (switching k);
    least := at_least least2 (Rmin a (ego_go k)) (unlimited k) (switching k) |}.
Proof. reflexivity. Qed.

Lemma clearing_is k r target :
  clearing k r target =
    (fst (until r target (ego_go k) (unlimited k)) + shortest_period k + switching k,
     snd (until r target (ego_go k) (unlimited k))).
Proof. reflexivity. Qed.

Lemma rest_is k r time : rest k r time = rest_of (at_most r (ego_go k) time) (ego_braking k).
Proof. reflexivity. Qed.

Lemma rush_is k v time : rush k v time = rushing (start v) (other_acceleration k) (other_max_speed k) time.
Proof. reflexivity. Qed.

Lemma dawdle_is k v time : dawdle k v time = at_least (start v) (- other_braking k) 0 time.
Proof. reflexivity. Qed.

Lemma safe_gap_is k w v :
  safe_gap k w v =
    Rmax (rest_of (rush k w (follower_reaction k)) (follower_braking k) - rest_of (start v) (hardest k)) 0.
Proof. reflexivity. Qed.

Lemma earliest_rest_is k w : earliest_rest k w = rest_of (start w) (other_braking k).
Proof. reflexivity. Qed.

Lemma unlimited_is k : unlimited k = Rmax (unheld k) (5368709 / 536870912).
Proof. reflexivity. Qed.

Lemma unlimited_unheld k : valid k -> unlimited k = unheld k.
Proof. intros ok. rewrite unlimited_is. apply Rmax_left, (unheld_enough k ok). Qed.

(** * Which command is in effect *)

Section Commands.
Variables (k : contract) (v : R -> R) (tau c : nat -> R).
Hypothesis ok : valid k.
Hypothesis nonneg : forall t, 0 <= v t.
Hypothesis grid : on_grid k tau.
Hypothesis obey : obeys k v tau c.

Lemma spacing i m :
  tau i + INR m * period k - 2 * jitter k <= tau (i + m)%nat <= tau i + INR m * period k + 2 * jitter k.
Proof.
  destruct grid as [g G]. pose proof (G i). pose proof (G (i + m)%nat) as G'. rewrite plus_INR in G'. lra.
Qed.

Lemma latency_fits i : tau i + latency k <= tau (S i).
Proof.
  pose proof (spacing i 1) as H. replace (i + 1)%nat with (S i) in H by lia. simpl INR in H.
  destruct ok. lra.
Qed.

Lemma calls_ordered i j : (i <= j)%nat -> tau i <= tau j.
Proof.
  induction 1; [lra |]. pose proof (latency_fits m). destruct ok. lra.
Qed.

Lemma at_most_point a t1 t2 : t2 <= t1 -> speeds_up_at_most v a t1 t2.
Proof.
  intros e t t' ? ? ?. replace (t' - t) with 0 by lra. assert (t' = t) by lra. subst.
  pose proof (nonneg t). cases; lra.
Qed.

Lemma at_least_point a cap t1 t2 : t2 <= t1 -> speeds_up_at_least v a cap t1 t2.
Proof.
  intros e t t' ? ? ?. replace (t' - t) with 0 by lra. assert (t' = t) by lra. subst.
  apply Rle_trans with (v t + a * 0); [apply Rmin_l | lra].
Qed.

Lemma at_least_join a cap t1 t2 t3 :
  speeds_up_at_least v a cap t1 t2 -> speeds_up_at_least v a cap t2 t3 -> speeds_up_at_least v a cap t1 t3.
Proof.
  intros H1 H2 t t' lo le hi.
  destruct (Rle_dec t' t2); [apply H1; lra |].
  destruct (Rle_dec t2 t); [apply H2; lra |].
  pose proof (H1 t t2 ltac:(lra) ltac:(lra) ltac:(lra)) as A.
  pose proof (H2 t2 t' ltac:(lra) ltac:(lra) ltac:(lra)) as B.
  assert (D : a * (t' - t) = a * (t2 - t) + a * (t' - t2)) by ring.
  destruct (Rle_dec 0 a).
  - assert (0 <= a * (t2 - t)) by nra. assert (0 <= a * (t' - t2)) by nra.
    revert A B. cases; lra.
  - assert (a * (t2 - t) <= 0) by nra. assert (a * (t' - t2) <= 0) by nra.
    revert A B. cases; lra.
Qed.

(* The command of a call may be in effect from the call until the latency after the next one. *)
Definition in_effect (t1 t2 : R) (j : nat) := tau j < t2 /\ t1 < tau (S j) + latency k.

Lemma one_period_up j a t1 t2 :
  tau (S j) <= t1 -> t2 <= tau (S (S j)) -> (forall q, (j <= q <= S j)%nat -> in_effect t1 t2 q -> c q <= a) ->
  speeds_up_at_most v a t1 t2.
Proof.
  intros lo hi below.
  destruct (Rle_dec t2 t1); [apply at_most_point; lra |].
  pose proof (latency_fits j). pose proof (latency_fits (S j)). destruct ok.
  assert (c (S j) <= a) by (apply below; [lia | split; lra]).
  assert (second : forall t, tau (S j) + latency k <= t -> speeds_up_at_most v a t t2).
  { intros. apply at_most_weaken with (c (S j)); [assumption |].
    apply at_most_within with (3 := stays_up k v tau c obey j); lra. }
  destruct (Rle_dec (tau (S j) + latency k) t1); [auto |].
  assert (c j <= a) by (apply below; [lia | split; lra]).
  assert (first : forall t, t <= tau (S j) + latency k -> speeds_up_at_most v a t1 t).
  { intros. apply at_most_weaken with (Rmax (c j) (c (S j))); [cases; lra |].
    apply at_most_within with (3 := switches_up k v tau c obey j); lra. }
  destruct (Rle_dec t2 (tau (S j) + latency k)); [auto |].
  apply at_most_join with (tau (S j) + latency k); auto; [apply first | apply second]; lra.
Qed.

Lemma one_period_down j a t1 t2 :
  tau (S j) <= t1 -> t2 <= tau (S (S j)) -> (forall q, (j <= q <= S j)%nat -> in_effect t1 t2 q -> a <= c q) ->
  speeds_up_at_least v a (unheld k) t1 t2.
Proof.
  intros lo hi above.
  destruct (Rle_dec t2 t1); [apply at_least_point; lra |].
  pose proof (latency_fits j). pose proof (latency_fits (S j)). destruct ok.
  assert (a <= c (S j)) by (apply above; [lia | split; lra]).
  assert (second : forall t, tau (S j) + latency k <= t -> speeds_up_at_least v a (unheld k) t t2).
  { intros. apply at_least_weaken with (c (S j)); [assumption |].
    apply at_least_within with (3 := stays_down k v tau c obey j); lra. }
  destruct (Rle_dec (tau (S j) + latency k) t1); [auto |].
  assert (a <= c j) by (apply above; [lia | split; lra]).
  assert (first : forall t, t <= tau (S j) + latency k -> speeds_up_at_least v a (unheld k) t1 t).
  { intros. apply at_least_weaken with (Rmin (c j) (c (S j))); [cases; lra |].
    apply at_least_within with (3 := switches_down k v tau c obey j); lra. }
  destruct (Rle_dec t2 (tau (S j) + latency k)); [auto |].
  apply at_least_join with (tau (S j) + latency k); auto; [apply first | apply second]; lra.
Qed.

(* A bound on every command that may be in effect bounds the motion. *)
Lemma commands_up i m a t1 t2 :
  tau (S i) <= t1 -> t2 <= tau (S i + m)%nat ->
  (forall j, (i <= j < S i + m)%nat -> in_effect t1 t2 j -> c j <= a) -> speeds_up_at_most v a t1 t2.
Proof.
  revert t2. induction m as [| m IH]; intros t2 lo hi below.
  { rewrite Nat.add_0_r in hi. apply at_most_point. lra. }
  replace (S i + S m)%nat with (S (S (i + m))) in hi by lia.
  set (x := tau (S i + m)%nat) in *.
  assert (X : x = tau (S (i + m))) by reflexivity.
  destruct (Rle_dec t2 x) as [early | late].
  { apply IH; auto. intros j [? ?] e. apply below; [lia | exact e]. }
  destruct (Rle_dec x t1) as [l | e].
  { apply one_period_up with (i + m)%nat; [lra | lra |]. intros q [? ?] eff. apply below; [lia | exact eff]. }
  apply at_most_join with x; auto.
  - apply IH; [lra | lra |]. intros j [? ?] [? ?]. apply below; [lia | split; lra].
  - apply one_period_up with (i + m)%nat; [lra | lra |]. intros q [? ?] [? ?]. apply below; [lia | split; lra].
Qed.

Lemma commands_down i m a t1 t2 :
  tau (S i) <= t1 -> t2 <= tau (S i + m)%nat ->
  (forall j, (i <= j < S i + m)%nat -> in_effect t1 t2 j -> a <= c j) -> speeds_up_at_least v a (unheld k) t1 t2.
Proof.
  revert t2. induction m as [| m IH]; intros t2 lo hi above.
  { rewrite Nat.add_0_r in hi. apply at_least_point. lra. }
  replace (S i + S m)%nat with (S (S (i + m))) in hi by lia.
  set (x := tau (S i + m)%nat) in *.
  assert (X : x = tau (S (i + m))) by reflexivity.
  destruct (Rle_dec t2 x) as [early | late].
  { apply IH; auto. intros j [? ?] e. apply above; [lia | exact e]. }
  destruct (Rle_dec x t1) as [l | e].
  { apply one_period_down with (i + m)%nat; [lra | lra |]. intros q [? ?] eff. apply above; [lia | exact eff]. }
  apply at_least_join with x.
  - apply IH; [lra | lra |]. intros j [? ?] [? ?]. apply above; [lia | split; lra].
  - apply one_period_down with (i + m)%nat; [lra | lra |]. intros q [? ?] [? ?]. apply above; [lia | split; lra].
Qed.

(* The ego never brakes harder than b. *)
Lemma ego_brakes_at_most i m t t' :
  tau (S i) <= t -> t <= t' -> t' <= tau (S i + m)%nat -> v t - ego_braking k * (t' - t) <= v t'.
Proof.
  intros lo le hi.
  assert (H : speeds_up_at_least v (- ego_braking k) (unheld k) t t').
  { apply commands_down with i m; auto. intros j _ _. apply (commanded k v tau c obey). }
  specialize (H t t' ltac:(lra) le ltac:(lra)).
  assert (0 <= ego_braking k * (t' - t)) by (destruct ok; apply Rmult_le_pos; lra).
  revert H. cases; lra.
Qed.

(** * The intervals of a plan *)

(* (i) 2: the accelerations under a plan of n periods of go, from the call T that verified it to the time E.
   Turns are counted from two jitters before the calls. *)
Record plan_followed (T E pl pm a : R) (n : nat) : Prop := {
  up1 u : T <= u <= E -> u <= T + switching k -> speeds_up_at_most v (Rmax pm a) T u;
  up2 u : T + switching k <= u <= E -> u <= T + shortest_period k -> speeds_up_at_most v a (T + switching k) u;
  up3 u : T + shortest_period k <= u <= E -> u <= T + shortest_period k + switching k ->
    speeds_up_at_most v (match n with O => a | S _ => Rmax a (ego_go k) end) (T + shortest_period k) u;
  up4 u : T + shortest_period k + switching k <= u <= E ->
    u <= T + shortest_period k + switching k + INR n * period k ->
    speeds_up_at_most v (ego_go k) (T + shortest_period k + switching k) u;
  up5 u : T + shortest_period k + switching k + INR n * period k <= u <= E ->
    speeds_up_at_most v (- ego_braking k) (T + shortest_period k + switching k + INR n * period k) u;
  down1 u : T <= u <= E -> u <= T + switching k -> speeds_up_at_least v (Rmin pl a) (unheld k) T u;
  down2 u : T + switching k <= u <= E -> u <= T + shortest_period k ->
    speeds_up_at_least v a (unheld k) (T + switching k) u;
  down3 u : T + shortest_period k <= u <= E -> u <= T + shortest_period k + switching k ->
    u <= T + shortest_period k + INR n * period k ->
    speeds_up_at_least v (Rmin a (ego_go k)) (unheld k) (T + shortest_period k) u;
  down4 u : T + shortest_period k + switching k <= u <= E -> u <= T + shortest_period k + INR n * period k ->
    speeds_up_at_least v (ego_go k) (unheld k) (T + shortest_period k + switching k) u
}.

Lemma switching_fits : 0 <= switching k <= shortest_period k /\ shortest_period k <= period k.
Proof. unfold switching, shortest_period. destruct ok. lra. Qed.

(* From a call on, the plan of a log is followed. *)
Variables (l : log).

Lemma plan_is_followed i m :
  previous_least l (S i) <= c i <= previous_most l (S i) ->
  (forall j, (S i <= j < S i + m)%nat -> carries_on k l c j) ->
  plan_followed (tau (S i)) (tau (S (S i) + m)%nat) (previous_least l (S i)) (previous_most l (S i)) (c (S i))
    (goes l (S i)).
Proof.
  intros prev carried.
  set (T := tau (S i)). set (n := goes l (S i)).
  destruct switching_fits as [[sw0 sw] sp].
  pose proof ok as ok'. destruct ok'.
  (* What the plan commands. *)
  assert (left : forall q, (q <= m)%nat -> goes l (S i + q)%nat = (n - q)%nat).
  { induction q as [| q IH]; intros hq; [rewrite Nat.add_0_r; unfold n; lia |].
    specialize (IH ltac:(lia)). pose proof (carried (S i + q)%nat ltac:(lia)) as C. unfold carries_on in C.
    replace (S i + S q)%nat with (S (S i + q)) by lia.
    rewrite IH in C. destruct (n - q)%nat as [| r] eqn:e; lia. }
  assert (go : forall q, (q < m)%nat -> (q < n)%nat -> c (S (S i) + q)%nat = ego_go k).
  { intros q hm hn. pose proof (carried (S i + q)%nat ltac:(lia)) as C. unfold carries_on in C.
    rewrite (left q ltac:(lia)) in C. destruct (n - q)%nat as [| r] eqn:e; [lia |].
    replace (S (S i) + q)%nat with (S (S i + q)) by lia. apply C. }
  assert (brake : forall q, (q < m)%nat -> (n <= q)%nat -> c (S (S i) + q)%nat = - ego_braking k).
  { intros q hm hn. pose proof (carried (S i + q)%nat ltac:(lia)) as C. unfold carries_on in C.
    rewrite (left q ltac:(lia)) in C. replace (n - q)%nat with O in C by lia.
    replace (S (S i) + q)%nat with (S (S i + q)) by lia. apply C. }
  (* When its commands may be in effect. *)
  assert (turn : forall q, T + shortest_period k + INR q * period k <= tau (S (S i) + q)%nat /\
                           tau (S (S i) + q)%nat + latency k <= T + shortest_period k + INR q * period k + switching k).
  { intros q. pose proof (spacing (S i) (S q)) as H. rewrite S_INR in H.
    replace (S i + S q)%nat with (S (S i) + q)%nat in H by lia. fold T in H.
    unfold shortest_period, switching. lra. }
  assert (later : forall p q, (p <= q)%nat -> INR p * period k <= INR q * period k).
  { intros p q h. apply Rmult_le_compat_r; [lra | apply le_INR, h]. }
  assert (a0 : - ego_braking k <= c (S i)) by apply (commanded k v tau c obey).
  (* Command i, command S i, or number q of the commands that follow. *)
  assert (which : forall j, (i <= j < S i + S m)%nat ->
            j = i \/ j = S i \/ exists q, (q < m)%nat /\ j = (S (S i) + q)%nat).
  { intros j h. destruct (Nat.eq_dec j i); [left; assumption |]. destruct (Nat.eq_dec j (S i)); [right; left; assumption |].
    right; right. exists (j - S (S i))%nat. lia. }
  assert (end_ : tau (S (S i) + m)%nat = tau (S i + S m)%nat) by (f_equal; lia).
  pose proof (turn O) as first. rewrite Nat.add_0_r in first. simpl INR in first.
  assert (T1 : forall q, T + shortest_period k + INR q * period k <= tau (S (S i) + q)%nat) by apply turn.
  assert (T2 : forall q, tau (S (S (S i) + q)) + latency k <= T + shortest_period k + (INR q + 1) * period k + switching k).
  { intros q. replace (S (S (S i) + q)) with (S (S i) + S q)%nat by lia. rewrite <- S_INR. apply turn. }
  assert (go_pos : forall q, 0 <= INR q * period k) by (intros; apply Rmult_le_pos; [apply pos_INR | lra]).
  assert (lat : latency k <= switching k) by (unfold switching; lra).
  assert (many : forall q, (1 <= q)%nat -> period k <= INR q * period k).
  { intros q h. pose proof (later 1%nat q h) as L. simpl INR in L. lra. }
  pose proof (go_pos n) as n0. destruct prev as [prev1 prev2].
  clearbody n. clear left carried turn.
  constructor; intros u [lo hi]; intros; rewrite end_ in hi;
    first [apply commands_up with i (S m) | apply commands_down with i (S m)]; try (unfold T in *; lra);
    intros j hj [e1 e2]; destruct (which j hj) as [-> | [-> | (q & hq & ->)]];
    fold T in e1, e2.
  all: try (destruct n; cases; lra).
  all: pose proof (T1 q) as Q1; pose proof (T2 q) as Q2; pose proof (go_pos q) as Q3.
  all: destruct (le_lt_dec n q) as [h | h];
    [ pose proof (brake q hq h) as C; pose proof (later n q h) as L
    | pose proof (go q hq h) as C; pose proof (later (S q) n h) as L; rewrite S_INR in L ].
  all: destruct (Nat.eq_dec q 0) as [-> | h1]; [simpl INR in * | pose proof (many q ltac:(lia)) as M].
  all: try (exfalso; lra).
  all: try (rewrite C; destruct n; cases; lra || lia).
Qed.
End Commands.
